"""Claims B27 to B29, beyond the paper: moduli that predict two peaks, incremental elasticity (Secs. IV, V.C, VIII)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims import asked
from granular_response_paper.claims.claim import Claims, Condition, Data, Finding, Quantity
from granular_response_paper.claims.words import Bounds

GROUP = "tangent_moduli"
CLAIMS = Claims(GROUP)


def _slabs(data: Data) -> dict[str, xr.Dataset]:
    """Slabs by friction, without steps that are not there."""
    found = data.get(GROUP, "slabs")
    known = np.isfinite(found["force"].values)
    return {f"friction {float(mu):g}": found.isel(slab=k, step=known[k]) for k, mu in enumerate(found["friction"])}


def _crossover(slab: xr.Dataset) -> Quantity:
    return Quantity.bracket(*slab["crossover"].values)


@CLAIMS.measures("B27")
def reach(data: Data, words: Bounds) -> Finding:
    found = {}
    for name, slab in _slabs(data).items():
        crossover, reached = _crossover(slab), slab["reach"].values.reshape(slab.sizes["step"], -1) >= 1.0
        if crossover.happens and reached[-1].all():
            force = slab["force"].values
            first = reached.argmax(axis=0)
            CLAIMS.needs(bool((first > 0).all()), f"{name}: the region of r < 0 reaches the floor at the first force")
            ends = np.concatenate([force[first - 1], force[first]])
            found[name] = Quantity(float(ends.mean()), float(ends.min()), float(ends.max()), "range").per(crossover)
    CLAIMS.needs(bool(found), "slabs holds no region of r < 0 that reaches the floor beside a crossover")
    return asked.each(
        "per force of the crossover: ",
        found,
        lambda one: asked.near("force at which r < 0 reaches the floor, per crossover", one, words, "about"),
    )


@CLAIMS.measures("B28")
def incrementally_elastic(data: Data, words: Bounds) -> Finding:
    found = {}
    for name, slab in _slabs(data).items():
        crossover = _crossover(slab)
        below = slab["force"].values <= crossover.low
        parts = {"up to the crossover": below, "beyond it": ~below} if crossover.happens else {"one peak": below}
        for part, inside in parts.items():
            if inside.any():
                largest = slab["difference"].values[inside].max(axis=0)
                found[f"{name}, {part}"] = Quantity.range(largest.ravel(), float("nan"))
    return asked.each(
        "the largest difference per largest response is ",
        found,
        lambda one: asked.at_most("difference per largest response", one, words, "nearly", "%"),
        unit="%",
    )


@CLAIMS.measures("B29")
def peaks(data: Data, words: Bounds) -> Finding:
    found = {}
    for name, slab in _slabs(data).items():
        wrong = (slab["predicted_two_peaks"] != slab["two_peaks"]).sum("step")
        found[f"{name}, {slab.sizes['step']} forces"] = Quantity.range(wrong.values.ravel())
    what = "forces with another number of peaks"
    return asked.each(f"{what}: ", found, lambda one: Condition(what, one, most=0.0))
