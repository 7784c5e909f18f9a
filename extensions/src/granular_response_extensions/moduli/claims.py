"""Claims B4, B5 and B27 to B29, beyond the paper: packings, and slabs under load, as elastic slabs."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Numbers, Quantity, materials, needs


def described(data: Data, solid: str) -> Numbers:
    """B4, B5, in the highest packings of each case."""
    for name, case in materials(data.get("moduli", "packings")):
        one = case.isel(size=int(np.nanargmax(case["layers"].values)), smoothing=0)
        found = over_realizations(one["difference"].sel(solid=solid).values, np.mean)
        yield f"{name}, {float(one['layers']):g} layers", found


def _slabs(data: Data) -> dict[str, xr.Dataset]:
    """Slabs by friction, without steps that are not there."""
    found = data.get("moduli", "slabs")
    known = np.isfinite(found["force"].values)
    return {f"friction {float(mu):g}": found.isel(slab=k, step=known[k]) for k, mu in enumerate(found["friction"])}


def reach(data: Data) -> Numbers:  # B27
    for name, slab in _slabs(data).items():
        crossover = Quantity.bracket(*slab["crossover"].values)
        reached = slab["reach"].values.reshape(slab.sizes["step"], -1) >= 1.0
        if crossover.happens and reached[-1].all():
            force, first = slab["force"].values, reached.argmax(axis=0)
            needs(bool((first > 0).all()), f"{name}: the region of r < 0 reaches the floor at the first force")
            ends = np.concatenate([force[first - 1], force[first]])
            yield name, Quantity.range(ends, float(ends.mean())).per(crossover)


def incrementally_elastic(data: Data) -> Numbers:  # B28
    found = {}
    for name, slab in _slabs(data).items():
        crossover = Quantity.bracket(*slab["crossover"].values)
        below = slab["force"].values <= crossover.low
        parts = {"up to the crossover": below, "beyond it": ~below} if crossover.happens else {"one peak": below}
        for part, inside in parts.items():
            for k, width in enumerate(slab["width"].values.tolist()) if inside.any() else ():
                largest = slab["difference"].isel(width=k).values[inside].max(axis=0)
                found[f"{name}, {part}, averages over {width:g} R"] = Quantity.range(largest.ravel(), float("nan"))
    yield from sorted(found.items(), key=lambda one: not one[0].startswith("friction 0.2, up"))


def peaks(data: Data) -> Numbers:  # B29
    for name, slab in _slabs(data).items():
        wrong = (slab["predicted_two_peaks"] != slab["two_peaks"]).sum("step")
        yield f"{name}, {slab.sizes['step']} forces", Quantity.range(wrong.values.ravel())
