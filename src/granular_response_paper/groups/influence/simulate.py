"""Where a packing is most sensitive, and Saint-Venant's principle (Sec. VI.C), from the influence of every disk.

The influence of a disk is what a small force on it adds to each floor disk (``solve.small_loads``). ``packings`` has,
for one packing of each case, what every disk sets in motion; ``saint_venant`` compares a force on a disk with two
halves of it on disks of the same row, to the left and to the right: the same force and the same torque. In an elastic
body what they differ by falls as the square of their separation over the distance: the force is the first of their
moments that is the same, the second one is not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from granular_response.observe.floor import floor_disks, interior_mask
from granular_response.scene import Packing, Scene
from granular_response.solve import Problem, influence
from granular_response.solve.small_loads import at_limit
from granular_response.state import FloatArray, State
from granular_response.store.result import LENGTH, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.influence.parameters import Parameters

#: Rows of loads of the fits.
FITS = ("all", "without the lowest", "without the highest")


@dataclass(frozen=True)
class Task:
    """One packing."""

    scene: Scene
    separations: tuple[int, ...]
    margin: float
    fitted: tuple[float, ...]


@dataclass(frozen=True)
class Outcome:
    position: FloatArray  #: (n, 2) x from the middle of the box
    radius: FloatArray  #: (n,)
    total: FloatArray  #: (n,) sum of the absolute answers of the floor disks to a vertical force
    height: FloatArray  #: (row,) mean height of the loads
    spacing: float  #: mean distance of neighbours in a row
    difference: FloatArray  #: (row, separation)
    exponent: FloatArray  #: (separation, fit) see ``decay``
    at_limit: int  #: contacts taken as sticking though at the Coulomb limit


def compute(task: Task) -> Outcome:
    """Raises what ``rest_state`` raises."""
    problem = Problem.from_scene(task.scene)
    rest = rest_state(problem)
    packing = problem.packing
    disks = floor_disks([rest], np.flatnonzero(packing.row == 0))
    found = influence(problem, rest, disks, sliding="stick")[:, :, 1]
    height, difference = differences(found, rest, packing, task.separations, task.margin)
    spacing = packing.width / float(np.max(packing.row_count))
    exponent = [
        decay(height, difference[:, k], spacing * apart, task.fitted) for k, apart in enumerate(task.separations)
    ]
    middle = np.array([0.5 * packing.width, 0.0])
    return Outcome(
        rest.position - middle, packing.radius, np.abs(found).sum(axis=0), height, spacing, difference,
        np.array(exponent), at_limit(problem, rest),
    )  # fmt: skip


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
    x, y = np.log(ratio), np.log(difference, where=difference > 0.0, out=np.zeros_like(difference))
    return np.array([-np.polyfit(x[rows], y[rows], 1)[0] for rows in (use, use[1:], use[:-1])])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``saint_venant`` and ``packings``."""
    cases, most = parameters.cases, max(case.realizations for case in parameters.cases)
    places = [(c, r) for c, case in enumerate(cases) for r in range(case.realizations)]
    tasks = []
    for c, r in places:
        friction = cases[c].friction
        changes = {"contact.friction": friction, "wall.friction": friction, "packing.realization": r}
        scene = parameters.base.updated({**changes, "packing.polydispersity": cases[c].polydispersity})
        tasks.append(Task(scene, parameters.separations, parameters.margin, parameters.fitted))
    outcomes = map_tasks(compute, tasks, what="packings")
    first = outcomes[0]
    shape = (len(cases), most)

    def of_realizations(name: str) -> FloatArray:
        values = np.full(shape + np.shape(getattr(first, name)), np.nan)
        for place, outcome in zip(places, outcomes, strict=True):
            values[place] = getattr(outcome, name)
        return values

    along = ("case", "realization")
    coordinates = {
        "polydispersity": variable("case", [case.polydispersity for case in cases], "polydispersity"),
        "friction": variable("case", [case.friction for case in cases], "friction between disks and of the walls"),
    }
    saint_venant = xr.Dataset(
        {
            "difference": variable(
                (*along, "row", "separation"),
                of_realizations("difference"),
                "what a unit force and two halves of it differ by, summed over the floor disks",
            ),
            "height": variable((*along, "row"), of_realizations("height"), f"mean height of the loads {LENGTH}"),
            "spacing": variable(along, of_realizations("spacing"), f"distance of neighbours in a row {LENGTH}"),
            "exponent": variable(
                (*along, "separation", "fit"),
                of_realizations("exponent"),
                "power of height with which the difference falls",
            ),
            "at_limit": variable(along, of_realizations("at_limit"), "contacts at the Coulomb limit, taken to stick"),
        },
        coords=coordinates
        | {
            "fit": variable("fit", list(FITS), "rows of loads that are used"),
            "separation": variable(
                "separation", parameters.separations, "of the halves from the disk, in places of the row"
            ),
        },
    )
    saint_venant.attrs.update({"fitted": list(parameters.fitted), "margin": parameters.margin})
    shown = [outcomes[places.index((c, 0))] for c in range(len(cases))]
    packings = xr.Dataset(
        {
            "position": variable(
                ("case", "disk", "axis"), np.stack([o.position for o in shown]), f"centre from the middle {LENGTH}"
            ),
            "radius": variable(("case", "disk"), np.stack([o.radius for o in shown]), f"disk radius {LENGTH}"),
            "total": variable(
                ("case", "disk"),
                np.stack([o.total for o in shown]),
                "sum of the absolute answers of all floor disks to a unit vertical force",
            ),
        },
        coords=coordinates | {"axis": variable("axis", ["x", "z"], "component")},
    )
    return labelled({"saint_venant": saint_venant, "packings": packings}, parameters.base)
