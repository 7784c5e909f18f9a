"""Claims B14 to B17, beyond the paper: what rolling resistance changes (Secs. V.F and VIII)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import xarray as xr

from granular_response_paper.claims.claim import Data, Numbers, Quantity, needs

GROUP = "rolling_resistance"


def _held(data: Data, rolling: int) -> Iterator[tuple[str, xr.Dataset]]:
    """Piles at the least friction with the smallest rolling friction (0) or the largest (-1), and their names."""
    found = data.get(GROUP, "thresholds").sortby("rolling_friction").isel(rolling_friction=rolling)
    for ramp, size in product(found["ramp"].values, found["layers"].values):
        gravity = f"in {ramp:g} sqrt(R/g)" if ramp else "at once"
        yield f"{size} layers, gravity {gravity}", found.sel(layers=size, ramp=ramp)


def without_resistance(data: Data) -> Numbers:  # B14
    for name, one in _held(data, 0):
        needs(float(one["rolling_friction"]) == 0.0, "thresholds holds nothing without rolling resistance")
        yield f"the core, {name}", Quantity.bracket(float(one["low"]), float(one["high"])), None
        yield f"every disk, {name}", None, float(one["loose_disks"])


def no_dip(data: Data) -> Numbers:  # B15
    piles = data.get(GROUP, "piles").sel(case="resisting")
    for size in piles["layers"]:
        yield f"friction of Fig. 17, {int(size)} layers", float(piles["floor_dip"].sel(layers=size))
    for name, one in _held(data, -1):
        yield f"least friction, {name}", float(one["floor_dip"])


def _slabs(data: Data, name: str = "slabs") -> xr.Dataset:
    found = data.get(GROUP, name).sortby("rolling_friction")
    needs(found.sizes["rolling_friction"] > 1, f"{name} holds one rolling friction, there is nothing to compare")
    return found


def small_load(data: Data) -> Numbers:  # B16
    response = _slabs(data)["floor_response"].isel(load=0)
    without = response.isel(rolling_friction=0)
    change = abs(response - without).max("floor_disk") / without.max("floor_disk")
    for mu in change["friction"]:
        yield f"friction {float(mu):g}", Quantity.range(change.sel(friction=mu).values[1:])


def cosserat(data: Data) -> Numbers:
    """B17: what is left of the squares, and the Cosserat length."""
    slabs, turned = (_slabs(data, name).isel(rolling_friction=slice(1, None)) for name in ("slabs", "torques"))
    loads = [(f"{load:g} mg", slabs.sel(load=load), [""]) for load in slabs["load"].values]
    loads += [(f"torque {load:g}", turned.sel(torque=load), ["", "decay_"]) for load in turned["torque"].values]
    for mu in slabs["friction"].values.tolist():
        for load, one, fits in loads:
            for fit in fits:
                numbers = (Quantity.range(one[f"{fit}{of}"].sel(friction=mu)) for of in ("unexplained", "length"))
                yield f"friction {mu:g}, {load}{', decay' if fit else ''}", *numbers
