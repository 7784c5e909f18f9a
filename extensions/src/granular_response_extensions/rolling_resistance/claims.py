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


def small_load(data: Data) -> Numbers:  # B16
    slabs = data.get(GROUP, "slabs").sortby("rolling_friction")
    without, *others = slabs["floor_response"].isel(load=0).transpose("rolling_friction", ...)
    needs(others, "slabs holds one rolling friction, there is nothing to compare")
    for mu in slabs["friction"].values:
        least = without.sel(friction=mu)
        changes = (abs(one.sel(friction=mu) - least).max() / least.max() for one in others)
        yield f"friction {mu:g}", Quantity.range(changes)
