"""The same slab prepared in several ways: what a growing force does to each, and from which force on (Sec. V).

In the paper the packing relaxes under gravity, which acts at once (Sec. III.C); with friction the slab at rest
remembers how it came. Each way to prepare it is loaded by the same forces, on one path. Without friction rest is one
minimum of the energy, and one way stands for all. How many contacts are fully mobilized at rest, and where the linear
range ends, is measured on disordered and on tapped slabs too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.scene import Scene
from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.solvers.problem import Problem
from granular_response.solvers.taps import tapped
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS
from granular_response.studies.measures import MARGINS
from granular_response.sweeps.rest import rest_state
from granular_response_extensions.preparation.parameters import Parameters
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, record, table
from granular_response_paper.tasks import computed


@record
class Prepared:
    """One slab and how it was prepared."""

    way: str = column("how the slab was prepared")
    gravity: str = column("how gravity came")
    ramp_time: float = column("time over which slow gravity grows in sqrt(radius/g)")
    damping_ratio: float = column("damping over critical damping")
    friction: float = column("coefficient of friction between disks")
    wall_friction: float = column("coefficient of friction of walls")


@record
class Mobilized:
    """Which contacts of a slab at rest are fully mobilized, and which force it bears in what way."""

    polydispersity: float = column("polydispersity")
    realization: int = column("realization of the disorder")
    taps: int = column("how often the slab was tapped")
    tap_amplitude: float = column("largest acceleration of the box in a tap in g; 0 untapped")
    mobilized_part: FloatArray = column(
        "part of the contacts of disks at rest whose tangential force is within a fraction of the Coulomb limit",
        "margin",
    )
    force: FloatArray = column(f"force of the event; nan if it does not come {WEIGHTS}", "name")


#: The events that are set against it; two peaks are asked of ordered slabs alone.
AGAINST = ("linear_range", "first_opening", "crossover")


@dataclass(frozen=True)
class PreparedSlab:
    prepared: Prepared
    events: list[slab.Event]
    mobilized: Mobilized


def compute(
    way: str, scene: Scene, taps: tuple[int, float, float], forces: tuple[float, ...], asymmetry: float
) -> PreparedSlab:
    """A slab settled as its ``scene`` says, tapped (number, amplitude, duration) and loaded by each of the forces."""
    problem = Problem.from_scene(scene)
    path = studies.LoadPath.of(scene, tapped(problem, rest_state(problem), *taps))
    states, measures = path.through(forces), studies.Measures(path)
    events = slab.locate(path, forces, studies.happenings(measures, states[0], asymmetry))
    packing, high = scene.packing.model_dump(), {event.name: event.high for event in events}
    if packing["polydispersity"]:
        high["crossover"] = np.nan
    part = np.array(measures.mobilised(path.rest)) / float(path.rest.pairs.touching.sum())
    against = np.array([high[name] for name in AGAINST])
    mobilized = Mobilized(packing["polydispersity"], packing["realization"], *taps[:2], part, against)
    gravity, contact = scene.preparation, scene.contact
    given = gravity.gravity, gravity.ramp_time, contact.damping_ratio, contact.friction, scene.wall.friction
    return PreparedSlab(Prepared(way, *given), events, mobilized)


def tasks(parameters: Parameters) -> dict[tuple[Any, ...], partial[PreparedSlab]]:
    """A task for each part, way and realization, and for the taps of each, by what sorts them as they are stored."""
    found = {}
    for p, part in enumerate(parameters.parts):
        forces = tuple(force for force in parameters.forces if force <= part.to)
        ways = [(k, way) for k, way in enumerate(parameters.ways) if not part.ways or way.name in part.ways]
        walls = part.friction if part.walls == "rough" else 0.0
        lattice = {"packing.lattice_constant": TOUCHING_LARGEST} if part.polydispersity else {}
        for (k, way), realization, taps in product(ways, range(part.realizations), part.tapped):
            given = material(part.polydispersity, realization, part.friction, walls)
            scene = parameters.base.updated(given | lattice | way.changes)
            place = part.polydispersity, walls, part.friction, k, p, realization, taps
            found[place] = partial(compute, way.name, scene, taps, forces, parameters.asymmetry)
    return found


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``events``, and, of all slabs, ``mobilized``."""
    asked = tasks(parameters)
    # the longest ramps of gravity take longest
    found = computed(asked, "prepared slabs", work=lambda place: asked[place].args[1].preparation.ramp_time)
    every = [found[place] for place in sorted(found)]
    cases = [one for one in every if not one.mobilized.polydispersity and not one.mobilized.taps]
    events = table([event for one in cases for event in one.events], "event")
    names = axes(name=(AGAINST, "event"), margin=(MARGINS, "fraction below the Coulomb limit"))
    mobilized = table([one.mobilized for one in every], "case")
    datasets = {
        "events": events.assign(_prepared([one for one in cases for _ in one.events], "event")),
        "mobilized": mobilized.assign(_prepared(every, "case")).assign_coords(names),
    }
    return labelled(datasets, parameters.base)


def _prepared(outcomes: Sequence[PreparedSlab], dimension: str) -> Mapping[Any, xr.Variable]:
    return table([one.prepared for one in outcomes], dimension).variables
