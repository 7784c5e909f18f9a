"""Claims B14 to B17, beyond the paper: what rolling resistance changes (Secs. V.F and VIII)."""

from __future__ import annotations

import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity, Reading
from granular_response_paper.claims.words import Bounds

GROUP = "rolling_resistance"
CLAIMS = Claims(GROUP)

#: Of the paper's pile with friction (Fig. 17).
FRICTION = 0.94
#: Mean radii below which a length of a continuum is none: that of one disk.
RADIUS = 1.0


def _held(data: Data, rolling: int) -> dict[str, xr.Dataset]:
    """Piles at the least friction with the smallest rolling friction (0) or the largest (-1), by their names."""
    found = data.get(GROUP, "thresholds")
    found = found.sortby("rolling_friction").isel(rolling_friction=rolling)
    return {
        f"{int(size)} layers, gravity {f'in {ramp:g} sqrt(R/g)' if ramp else 'at once'}": found.sel(
            layers=size, ramp=ramp
        )
        for ramp in found["ramp"].values
        for size in found["layers"].values
    }


def _bracket(one: xr.Dataset) -> Quantity:
    return Quantity.bracket(float(one["low"]), float(one["high"]))


@CLAIMS.measures("B14")
def without_resistance(data: Data, words: Bounds) -> Finding:
    least, most = _held(data, 0), _held(data, -1)
    there = all(float(one["rolling_friction"]) == 0.0 for one in least.values())
    CLAIMS.needs(there, "thresholds holds nothing without rolling resistance")
    largest = float(next(iter(most.values()))["rolling_friction"])
    resisting = asked.listed({name: _bracket(one) for name, one in most.items()})
    return asked.each(
        "without rolling resistance: ",
        {name: _bracket(one) for name, one in least.items()},
        lambda one: Condition("least friction that holds the pile", one, FRICTION),
        remark=f"With rolling friction {largest:g}: {resisting}. Asked for more than {FRICTION:g}, the friction of the "
        "paper's pile. The pile is placed, not built disk by disk",
    )


@CLAIMS.measures("B15")
def no_dip(data: Data, words: Bounds) -> Finding:
    piles = data.get(GROUP, "piles").sel(case="resisting")
    dips = {f"friction of Fig. 17, {int(n)} layers": float(piles["floor_dip"].sel(layers=n)) for n in piles["layers"]}
    dips |= {f"least friction, {name}": float(one["floor_dip"]) for name, one in _held(data, -1).items()}
    CLAIMS.needs(all(dip == dip for dip in dips.values()), "thresholds lacks a pile that rolling resistance holds")
    return asked.each(
        "with the largest rolling friction: ",
        dips,
        lambda dip: asked.at_most("dip per largest force", dip, words, "visible", "%"),
        form=".1%",
    )


def _slabs(data: Data, name: str = "slabs") -> xr.Dataset:
    found = data.get(GROUP, name).sortby("rolling_friction")
    CLAIMS.needs(found.sizes["rolling_friction"] > 1, f"{name} holds one rolling friction, there is nothing to compare")
    return found


@CLAIMS.measures("B16")
def small_load(data: Data, words: Bounds) -> Finding:
    response = _slabs(data)["floor_response"].isel(load=0)
    without = response.isel(rolling_friction=0)
    change = abs(response - without).max("floor_disk") / without.max("floor_disk")
    return asked.each(
        "the response to the small load changes by ",
        {f"friction {float(mu):g}": Quantity.range(change.sel(friction=mu).values[1:]) for mu in change["friction"]},
        lambda one: asked.at_least("change per largest response", one, words, "nearly", "%"),
        unit="%",
    )


@CLAIMS.measures("B17")
def cosserat(data: Data, words: Bounds) -> Finding:
    slabs, turned = (_slabs(data, name).isel(rolling_friction=slice(1, None)) for name in ("slabs", "torques"))
    loads = [(f"{load:g} mg", slabs.sel(load=load), [""]) for load in slabs["load"].values]
    loads += [(f"torque {load:g}", turned.sel(torque=load), ["", "decay_"]) for load in turned["torque"].values]
    readings, lengths = [], []
    for mu in slabs["friction"].values.tolist():
        for load, one, fits in loads:
            name, conditions = f"friction {mu:g}, {load}", []
            for fit in fits:
                left, length = (Quantity.range(one[f"{fit}{of}"].sel(friction=mu)) for of in ("unexplained", "length"))
                of_decay = " of the decay" if fit else ""
                lengths.append(f"{length.text()}, {left.text('%')} left ({name}{of_decay and ', decay'})")
                conditions += [
                    asked.at_most(f"part of the squares{of_decay} that is left", left, words, "quite well", "%"),
                    Condition(f"Cosserat length{of_decay} in radii", length, RADIUS),
                ]
            readings.append(Reading(name, *conditions))
    return Finding(f"the Cosserat length is {'; '.join(lengths)}", readings)
