"""Where a packing is most sensitive, and Saint-Venant's principle (Sec. VI.C), from the influence of every disk.

The influence of a disk is what a small force on it adds to each floor disk (``solvers.small_loads``). ``packings`` has,
for one packing of each case, what every disk sets in motion; ``saint_venant`` compares a force on a disk with two
halves of it on disks of the same row, to the left and to the right: the same force and the same torque. In an elastic
body what they differ by falls as the square of their separation over the distance: the force is the first of their
moments that is the same, the second one is not.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.observe.floor import floor_disks, interior_mask
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.small_loads import influence
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII
from granular_response.sweeps.rest import rest_state
from granular_response_extensions.influence.parameters import Parameters
from granular_response_paper.datasets import labelled
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, labels, record, table
from granular_response_paper.tasks import computed

#: Rows of loads of the fits.
FITS = ("all", "without the lowest", "without the highest")


@record
class PackingInfluence:
    difference: FloatArray = column(
        "what a unit force and two halves of it differ by, summed over the floor disks", "row", "separation"
    )
    exponent: FloatArray = column("power of height with which the difference falls", "separation", "fit")
    position: FloatArray = column(f"centre from the middle {RADII}", "disk", "axis")
    radius: FloatArray = column(f"disk radius {RADII}", "disk")
    total: FloatArray = column("sum of the absolute answers of all floor disks to a unit vertical force", "disk")


def compute(scene: Scene, separations: tuple[int, ...], margin: float, fitted: tuple[float, ...]) -> PackingInfluence:
    """One packing. Raises what ``rest_state`` raises."""
    problem = Problem.from_scene(scene)
    rest, packing = rest_state(problem), problem.packing
    disks = floor_disks([rest], np.flatnonzero(packing.row == 0))
    found = influence(problem, rest, disks, sliding="stick")[:, :, 1]
    height, difference = differences(found, rest, packing, separations, margin)
    spacing = packing.width / float(np.max(packing.row_count))
    exponent = [decay(height, difference[:, k], spacing * apart, fitted) for k, apart in enumerate(separations)]
    middle = np.array([0.5 * packing.width, 0.0])
    total = np.abs(found).sum(axis=0)
    return PackingInfluence(difference, np.array(exponent), rest.position - middle, packing.radius, total)


def differences(
    found: FloatArray, rest: State, packing: Packing, separations: tuple[int, ...], margin: float
) -> tuple[FloatArray, FloatArray]:
    """What one force and its two halves differ by on the floor.

    ``found`` (k, n) are the answers of k floor disks to vertical forces. Returns the mean height of the loads of
    each row (row,), and (row, separation) the sum of the absolute differences over the floor disks, averaged over the
    disks of the row that are ``margin`` from the side walls; NaN where there are none.
    """
    rows = int(packing.row.max()) + 1
    inside = interior_mask(rest.position[:, 0], packing.width, margin)
    height = np.full(rows, np.nan)
    result = np.full((rows, len(separations)), np.nan)
    for row in range(rows):
        disks = np.flatnonzero(packing.row == row)
        disks = disks[np.argsort(rest.position[disks, 0], kind="stable")]
        height[row] = rest.position[disks, 1].mean()
        for k, apart in enumerate(separations):
            at = np.arange(apart, len(disks) - apart)
            at = at[inside[disks[at]]]
            halves = 0.5 * (found[:, disks[at - apart]] + found[:, disks[at + apart]])
            each = np.abs(found[:, disks[at]] - halves).sum(axis=0)
            if np.isfinite(each).any():
                result[row, k] = np.nanmean(each)  # disks that bear nothing have no answer
    return height, result


def decay(height: FloatArray, difference: FloatArray, apart: float, fitted: tuple[float, ...]) -> FloatArray:
    """(fit,) powers of height over separation ``apart`` with which ``difference`` falls: slopes of logarithms.

    ``fitted`` are the least and the largest height over separation that are used; of the three fits the second leaves
    out the lowest of these rows and the third the highest. NaN with less than four rows.
    """
    ratio = height / apart
    use = np.flatnonzero((ratio >= fitted[0]) & (ratio <= fitted[1]) & (difference > 0.0))
    if use.size < 4:
        return np.full(len(FITS), np.nan)
    x, y = np.log(ratio[use]), np.log(difference[use])
    return np.array([-np.polyfit(x[rows], y[rows], 1)[0] for rows in (slice(None), slice(1, None), slice(-1))])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``saint_venant`` and ``packings``, the first one of each case."""
    tasks = {}
    for c, case in enumerate(parameters.cases):
        for r in range(case.realizations):
            scene = parameters.base.updated(material(case.polydispersity, r, case.friction))
            tasks[c, r] = partial(compute, scene, parameters.separations, parameters.margin, parameters.fitted)
    texts = {"polydispersity": "polydispersity", "friction": "friction between disks and of the walls"}
    found = table(computed(tasks, "packings"), "case", "realization")
    found = found.assign_coords(labels("case", parameters.cases, **texts))
    of_packings = ["position", "radius", "total"]
    saint_venant = found.drop_vars(of_packings).assign_coords(
        axes(
            fit=(FITS, "rows of loads that are used"),
            separation=(parameters.separations, "of the halves from the disk, in places of the row"),
        )
    )
    packings = found[of_packings].isel(realization=0).assign_coords(axes(axis=("xz", "component")))
    return labelled({"saint_venant": saint_venant, "packings": packings}, parameters.base)
