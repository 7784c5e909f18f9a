"""Claims B14 to B17, beyond the paper: what rolling resistance changes (Secs. V.F and VIII)."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims import bounds
from granular_response_paper.claims.claim import Bound, Data, Quantity, Test
from granular_response_paper.claims.declared import Claims
from granular_response_paper.claims.words import Words

GROUP = "rolling_resistance"
CLAIMS = Claims(__package__)

#: Of the paper's pile with friction (Fig. 17). And mean radii below which a length of a continuum is none: one disk's.
FRICTION, RADIUS = 0.94, 1.0


def _held(data: Data, rolling: int) -> dict[str, xr.Dataset]:
    """Piles at the least friction with the smallest rolling friction (0) or the largest (-1), by their names."""
    found = data.get(GROUP, "thresholds").sortby("rolling_friction").isel(rolling_friction=rolling)
    return {
        f"{int(size)} layers, gravity {f'in {ramp:g} sqrt(R/g)' if ramp else 'at once'}": found.sel(
            layers=size, ramp=ramp
        )
        for ramp in found["ramp"].values
        for size in found["layers"].values
    }


@CLAIMS.measures("B14")
def without_resistance(data: Data, words: Words) -> list[Test]:
    tests = []
    for name, one in _held(data, 0).items():
        CLAIMS.needs(float(one["rolling_friction"]) == 0.0, "thresholds holds nothing without rolling resistance")
        least, loose = (
            Quantity.bracket(float(one["low"]), float(one["high"])),
            Quantity.exact(float(one["loose_disks"])),
        )
        tests.append(Test("least friction that holds the core", least, Bound(FRICTION), f"the core, {name}"))
        tests.append(Test("disks that leave the pile", loose, Bound(1.0), f"every disk, {name}"))
    return tests


@CLAIMS.measures("B15")
def no_dip(data: Data, words: Words) -> list[Test]:
    piles = data.get(GROUP, "piles").sel(case="resisting")
    dips = {f"friction of Fig. 17, {int(n)} layers": float(piles["floor_dip"].sel(layers=n)) for n in piles["layers"]}
    dips |= {f"least friction, {name}": float(one["floor_dip"]) for name, one in _held(data, -1).items()}
    visible = bounds.at_most(words, "visible")
    return [Test("dip per largest force", Quantity.exact(dip), visible, case, "%") for case, dip in dips.items()]


def _slabs(data: Data, name: str = "slabs") -> xr.Dataset:
    found = data.get(GROUP, name).sortby("rolling_friction")
    CLAIMS.needs(found.sizes["rolling_friction"] > 1, f"{name} holds one rolling friction, there is nothing to compare")
    return found


@CLAIMS.measures("B16")
def small_load(data: Data, words: Words) -> list[Test]:
    response = _slabs(data)["floor_response"].isel(load=0)
    without = response.isel(rolling_friction=0)
    change = abs(response - without).max("floor_disk") / without.max("floor_disk")
    found = {f"friction {float(mu):g}": Quantity.range(change.sel(friction=mu).values[1:]) for mu in change["friction"]}
    least = bounds.at_least(words, "nearly")
    return [Test("change per largest response", one, least, case, "%") for case, one in found.items()]


@CLAIMS.measures("B17")
def cosserat(data: Data, words: Words) -> list[Test]:
    slabs, turned = (_slabs(data, name).isel(rolling_friction=slice(1, None)) for name in ("slabs", "torques"))
    loads = [(f"{load:g} mg", slabs.sel(load=load), [""]) for load in slabs["load"].values]
    loads += [(f"torque {load:g}", turned.sel(torque=load), ["", "decay_"]) for load in turned["torque"].values]
    tests = []
    for mu in slabs["friction"].values.tolist():
        for load, one, fits in loads:
            for fit in fits:
                left, length = (Quantity.range(one[f"{fit}{of}"].sel(friction=mu)) for of in ("unexplained", "length"))
                case = f"friction {mu:g}, {load}{', decay' if fit else ''}"
                tests.append(Test("part of the squares left", left, bounds.at_most(words, "quite well"), case, "%"))
                tests.append(Test("Cosserat length in radii", length, Bound(RADIUS), case))
    return tests
