"""Claims F5 to F10: the ordered slab without friction (Sec. IV)."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import FloatArray
from granular_response_paper.claims.claim import Case, Data, Numbers, Quantity, needs

GROUP = "frictionless_crossover"

#: The paper's stiffness of contacts.
STIFFNESS = 3000.0

#: Distance of two rows of disks, and of two disks in a row (mean radii): the resolution of a region's size.
ROW, DISK = float(np.sqrt(3.0)), 2.0


def _open_regions(data: Data) -> list[tuple[float, NDArray[Any]]]:
    """Horizontal share of the opened contacts, and contacts by row from below, until the floor is reached."""
    states = data.get(GROUP, "states")
    first, second = states["contact_disk"].values, states["contact_partner"].values
    found = []
    for inside, position in zip(states["teardrop"].values.astype(bool), states["position"].values, strict=True):
        height = position[:, 1]
        rows = np.round(0.5 * (height[first] + height[second])[inside] / ROW).astype(int)
        if rows.size and rows.min() > 1:
            share = float((np.abs(height[first] - height[second])[inside] < 0.5 * ROW).mean())
            found.append((share, np.bincount(rows - rows.min())))
    return found


def horizontal(data: Data) -> Numbers:  # F5a
    yield "", min(share for share, _ in _open_regions(data))


def teardrop(data: Data) -> Numbers:  # F5b
    widest = _open_regions(data)[-1][1]
    depth = data.get(GROUP, "response")["teardrop_depth"].values / ROW
    needs(len(widest) > 3, "no region of four rows that has not reached the floor")
    yield "", widest.max() / max(widest[0], widest[-1]), np.diff(depth).min(), depth.max() - depth[0]


def size_in_steps(size: FloatArray, step: float) -> Quantity:
    """The mean of a size over evenly spaced forces at which it grows by whole steps.

    A size is rounded down, by half a step in the mean over each whole step that it grows. So the mean lacks half a
    step, to within half a step over the number of steps grown.
    """
    steps = max(1.0, float(size.max() - size.min()) / step)
    mean, off = float(size.mean()) + 0.5 * step, 0.5 * step / steps
    return Quantity(mean, mean - off, mean + off, "bracket")


def _slabs(data: Data, name: str) -> xr.Dataset:
    """Slabs of the paper's stiffness by the number of their layers."""
    study = data.get(GROUP, name).sortby("layers")
    return study.isel(slab=np.isclose(study["normal_stiffness"].values, STIFFNESS))


def teardrop_and_depth(data: Data) -> Numbers:  # F6
    slabs = _slabs(data, "regions")
    layers = slabs["layers"].values
    use = (slabs["reaches_floor"].values[0] == 0) & (slabs["teardrop_depth"].values[0] > 2.0 * ROW)
    for k in range(1, len(layers)):
        for what, step in (("depth", ROW), ("width", DISK)):
            thin, deep = (size_in_steps(slabs[f"teardrop_{what}"].values[slab, use], step) for slab in (0, k))
            yield Case(f"{layers[k]:g} layers", f"{what} per that in {layers[0]:g}"), deep.per(thin)


def deep_and_shallow(data: Data) -> Numbers:  # F7
    found = {}
    for name in ("sizes", "widths"):
        slabs = _slabs(data, name)
        slabs = slabs.isel(slab=slabs["open_at_rest"].values == 0)
        layers, row = (slabs[key].values.tolist() for key in ("layers", "disks_per_row"))
        for thin, deep in combinations(range(len(layers)), 2):
            # of the first, the width grows with the depth; of the second, walls are at the same distance
            if layers[thin] == min(layers) < layers[deep] and (name == "sizes" or abs(row[thin] - row[deep]) <= 1):
                shallow, other = (Quantity.bracket(*slabs["crossover_bracket"].values[k]) for k in (thin, deep))
                case = f"{layers[deep]} x {row[deep]} against {layers[thin]} x {row[thin]} disks"
                found[case] = other.per(shallow)
    yield from found.items()


def _between(data: Data) -> xr.Dataset:
    """The study of stiffness for k_N from 1000 to 1e5. Raises NotMeasured if it does not span them."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    stiffness = study["normal_stiffness"].values
    chosen = (stiffness >= 999.0) & (stiffness <= 1.001e5)
    there = chosen.any() and stiffness[chosen].min() < 1001.0 and stiffness[chosen].max() > 0.99e5
    needs(there, "stiffness does not span 1000 to 1e5")
    return study.isel(normal_stiffness=chosen)


def stiffness_response(data: Data) -> Numbers:  # F8
    study = _between(data)
    values = study["response_at_centre"].transpose("normal_stiffness", "force").values
    for force, low, high, last in zip(study["force"].values, values.min(0), values.max(0), values[-1], strict=True):
        yield f"{force:g} mg", (high - low) / abs(last)


def stiffness_teardrop(data: Data) -> Numbers:
    """F9: what depth and width change by at high stiffness, and how the depth grows."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    high = study["normal_stiffness"].values >= 2000.0
    depth, width = study["teardrop_depth"].values, study["teardrop_width"].values
    use = (depth[-1] > 2.0 * ROW) & ~study["reaches_floor"].values.astype(bool).any(axis=0)
    needs(high.sum() > 1 and not high.all(), "stiffness holds too few stiffnesses to compare")
    spread = ((np.ptp(size[high], axis=0) / size[-1]).max() for size in (depth[:, use], width[:, use]))
    yield "", *spread, ((depth[-1] - depth[0])[use] / ROW).max()


def crossover_and_stiffness(data: Data) -> Numbers:  # F10
    study = _between(data)
    by_dip = np.moveaxis(study["crossovers"].values, 1, 0)
    definitions = {"two peaks, each above the response at x = 0": study["crossover_bracket"].values}
    definitions |= {f"a dip above {dip:.1%}": one for dip, one in zip(study["dip"].values, by_dip, strict=True)}
    for case, brackets in definitions.items():
        ratios = [Quantity.bracket(*one).per(Quantity.bracket(*brackets[-1])) for one in brackets[:-1]]
        yield case, Quantity.range([end for r in ratios for end in (r.low, r.high)], ratios[0].value)
