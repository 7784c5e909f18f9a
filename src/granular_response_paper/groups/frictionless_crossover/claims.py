"""Claims F5 to F10: the ordered slab without friction (Sec. IV)."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response_paper.claims.claim import Case, Data, Numbers, Quantity, needs

GROUP = "frictionless_crossover"

#: Distance of two rows of disks, and of two disks in a row (mean radii): the resolution of a region's size.
ROW, DISK = float(np.sqrt(3.0)), 2.0


def _before_the_floor(data: Data) -> xr.Dataset:
    """The states in which the region of opened contacts has not reached the floor."""
    return data.get(GROUP, "states").isel(force=data.get(GROUP, "response")["reaches_floor"].values == 0)


def horizontal(data: Data) -> Numbers:  # F5a
    yield "", _before_the_floor(data)["teardrop_horizontal"].min().item()


def teardrop(data: Data) -> Numbers:
    """F5b: contacts by row of the largest region, and its depth at all forces."""
    last = _before_the_floor(data).isel(force=-1)
    height = last["position"].values[:, 1]
    middle = 0.5 * (height[last["contact_disk"].values] + height[last["contact_partner"].values])
    rows = np.round(middle[last["teardrop"].values.astype(bool)] / ROW).astype(int)
    widths = np.bincount(rows - rows.min())
    depth = data.get(GROUP, "response")["teardrop_depth"].values / ROW
    needs(len(widths) > 3, "no region of four rows that has not reached the floor")
    yield "", widths.max() / max(widths[0], widths[-1]), np.diff(depth).min(), depth.max() - depth[0]


def size_in_steps(size: FloatArray, step: float) -> Quantity:
    """The mean of a size over evenly spaced forces at which it grows by whole steps.

    A size is rounded down, by half a step in the mean over each whole step that it grows. So the mean lacks half a
    step, to within half a step over the number of steps grown.
    """
    steps = max(1.0, float(size.max() - size.min()) / step)
    mean, off = float(size.mean()) + 0.5 * step, 0.5 * step / steps
    return Quantity(mean, mean - off, mean + off, "bracket")


def _slabs(data: Data, name: str) -> xr.Dataset:
    """Slabs of the paper's stiffness of contacts, 3000, by the number of their layers."""
    study = data.get(GROUP, name).sortby("layers")
    return study.isel(slab=np.isclose(study["normal_stiffness"].values, 3000.0))


def teardrop_and_depth(data: Data) -> Numbers:  # F6
    slabs = _slabs(data, "regions")
    thin = slabs.isel(slab=0)
    slabs = slabs.isel(force=(thin["reaches_floor"].values == 0) & (thin["teardrop_depth"].values > 2.0 * ROW))
    first, *others = slabs["layers"].values
    for k, layers in enumerate(others, 1):
        for what, step in (("depth", ROW), ("width", DISK)):
            shallow, deep = (size_in_steps(slabs[f"teardrop_{what}"].values[slab], step) for slab in (0, k))
            yield Case(f"{layers:g} layers", f"{what} per that in {first:g}"), deep.per(shallow)


def deep_and_shallow(data: Data) -> Numbers:  # F7
    found = {}
    for name in ("sizes", "widths"):
        slabs = _slabs(data, name)
        slabs = slabs.isel(slab=slabs["open_at_rest"].values == 0)
        columns = (slabs[key].values.tolist() for key in ("layers", "disks_per_row", "crossover_bracket"))
        for (thin, few, shallow), (layers, row, deep) in combinations(zip(*columns, strict=True), 2):
            # of the first, the width grows with the depth; of the second, walls are at the same distance
            if thin == slabs["layers"].min() < layers and (name == "sizes" or abs(few - row) <= 1):
                case = f"{layers} x {row} against {thin} x {few} disks"
                found[case] = Quantity.bracket(*deep).per(Quantity.bracket(*shallow))
    yield from found.items()


def _between(data: Data) -> xr.Dataset:
    """The study of stiffness for k_N from 1000 to 1e5. Raises NotMeasured if it does not span them."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness").sel(normal_stiffness=slice(999.0, 1.001e5))
    stiffness = study["normal_stiffness"].values
    needs(stiffness.size and stiffness[0] < 1001.0 and stiffness[-1] > 0.99e5, "stiffness does not span 1000 to 1e5")
    return study


def stiffness_response(data: Data) -> Numbers:  # F8
    study = _between(data)
    by_force = study["response_at_centre"].transpose("force", ...).values
    for force, values in zip(study["force"].values, by_force, strict=True):
        yield f"{force:g} mg", np.ptp(values) / abs(values[-1])


def stiffness_teardrop(data: Data) -> Numbers:
    """F9: what depth and width change by at high stiffness, and how the depth grows."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    high = study["normal_stiffness"].values >= 2000.0
    needs(high.sum() > 1 and not high.all(), "stiffness holds too few stiffnesses to compare")
    depth, width = study["teardrop_depth"].values, study["teardrop_width"].values
    use = (depth[-1] > 2.0 * ROW) & ~study["reaches_floor"].values.astype(bool).any(axis=0)
    spread = ((np.ptp(size[high], axis=0) / size[-1]).max() for size in (depth[:, use], width[:, use]))
    yield "", *spread, (depth[-1] - depth[0])[use].max() / ROW


def crossover_and_stiffness(data: Data) -> Numbers:  # F10
    study = _between(data)
    definitions = {"two peaks, each above the response at x = 0": study["crossover_bracket"].values}
    definitions |= {f"a dip above {dip:.1%}": study["crossovers"].sel(dip=dip).values for dip in study["dip"].values}
    for case, brackets in definitions.items():
        ratios = [Quantity.bracket(*one).per(Quantity.bracket(*brackets[-1])) for one in brackets[:-1]]
        yield case, Quantity.range([end for r in ratios for end in (r.low, r.high)], ratios[0].value)
