"""How the crossover from one peak to two depends on the size of a slab (Secs. IV.B and VIII), with friction too.

The paper calls the crossover a finite-size effect: gravity presses contacts together, a force opens them, and the
deeper a slab the more force it takes. What scales here is said apart. The *series* are slabs that differ in one
quantity: the number of layers, the width over the depth, the stiffness, or the *confinement*, the force that horizontal
contacts bear at rest. On a lattice with periodic sides gravity gives them none: all distances in a row are those of the
period, so the confinement is chosen, by a lattice constant a little below two radii. In series of layers the stiffness
grows with the layers, so that gravity makes the same overlaps at every depth, and the confinement is constant, as
between the paper's walls, or grows with the weight as well.

Forces grow by one factor until the response has two peaks and the region of open contacts has reached the floor; events
are then those of the path, or narrowed between two of them. Without friction every state is a minimum of the energy,
and what happens is narrowed by bisection.

The deepest slabs are simulated by the survey (:mod:`granular_response_paper.survey.simulate`), as the others are.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.scene import Scene
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS, variable
from granular_response.studies import Happening, LoadPath, Measures, by_motion
from granular_response.studies.measures import FIRST_OPENING, REACHES_FLOOR, TWO_PEAKS
from granular_response.studies.path import NARROW
from granular_response_extensions.crossover_scaling.parameters import Parameters
from granular_response_extensions.crossover_scaling.simulate.series import ScaledSlab, packings, power_table, slabs
from granular_response_extensions.surveyed import measured
from granular_response_paper.datasets import labelled
from granular_response_paper.records import axes, column, record, table

EVENTS = {
    "first_opening": FIRST_OPENING,
    "crossover": "the floor response at x = 0 is visibly below both maxima beside it",
    "two_peaks": TWO_PEAKS,
    "reaches_floor": REACHES_FLOOR,
}


@record
class SlabEvents:
    """What a task leaves behind."""

    confinement: float = column(f"mean force of horizontal contacts in the central third at rest {WEIGHTS}")
    #: nan above for what was not seen
    brackets: FloatArray = column(f"forces {WEIGHTS} between which: {'; '.join(EVENTS.values())}", "event", "bracket")
    by_motion: float = column("steps of the force in which the motion of the disks had a part; nan: not recorded")


def compute(
    scene: Scene, visible: float, first_force: float, factor: float, most_forces: int, tolerance: float
) -> SlabEvents:
    """The path of one slab; the parameters are those of the group.

    Raises what ``rest_state`` and load paths raise.
    """
    path = LoadPath.of(scene)
    measures = Measures(path)
    confinement = measures.confinement
    asked = [  # in the order of EVENTS
        studies.first_opening(measures),
        Happening(lambda state: measures.dip(state) > visible, EVENTS["crossover"]),
        studies.two_peaks(measures),
        studies.reaches_floor(measures),
    ]
    forces: list[float] = []
    left = asked
    while left and len(forces) < most_forces:
        forces.append(confinement * first_force * factor ** len(forces))
        state = path.at(forces[-1])
        left = [what for what in left if not what.happened(state)]
    states = path.through(forces)
    width = NARROW if scene.contact.friction else tolerance
    brackets = np.array([path.first(forces, what, width) for what in asked])
    return SlabEvents(confinement, brackets, float(sum(map(by_motion, states))))


def task(asked: Parameters, slab: ScaledSlab) -> partial[SlabEvents]:
    """One of these slabs."""
    given = asked.visible, asked.first_force, asked.factor, asked.most_forces, asked.tolerance
    return partial(compute, slab.scene(asked.base), *given)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``slabs`` (slab), what each is, and its events; and ``powers`` (series).

    Raises SweepError if a slab cannot be solved.
    """
    done = measured(parameters, "slabs", packings, task, SlabEvents, work=lambda slab: slab.work)
    found, stored = slabs(parameters), packings(parameters, surveyed=True)
    of, data = table([slab for _, slab in found], "slab"), table([done[slab] for _, slab in found], "slab")
    brackets = {}
    for k, (name, event) in enumerate(EVENTS.items()):
        text = f"forces {WEIGHTS} between which: {event}; nan if not up to the first"
        brackets[f"{name}_bracket"] = variable(("slab", "bracket"), data["brackets"].values[:, k], text)
    kept = of[["layers", "disks_per_row", "friction", "normal_stiffness"]].variables
    coordinates = {
        "series": variable("slab", [series.name for series, _ in found], "series"),
        "periodic": of["periodic"].variable.astype(int),
        "surveyed": variable("slab", [int(slab in stored) for _, slab in found], "1 for slabs of the survey"),
        **axes(bracket=(["low", "high"], "ends of a bracket")),
    }
    each = xr.Dataset(brackets).assign(data[["confinement", "by_motion"]].variables)
    each = each.assign_coords(kept).assign_coords(coordinates)
    each = each.assign_attrs(visible=parameters.visible, tolerance=parameters.tolerance)
    return labelled({"slabs": each, "powers": power_table(each, parameters)}, parameters.base)
