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
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.solvers.dynamics import Dynamics, Stop
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import PROTOCOL, settle
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import FloatArray, State
from granular_response.store.variables import WEIGHTS
from granular_response.sweeps.rest import rest_state
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.preparation.parameters import Parameters, Part
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

    @classmethod
    def of(cls, way: str, scene: Scene) -> Prepared:
        preparation, contact = scene.preparation, scene.contact
        given = preparation.gravity, preparation.ramp_time, contact.damping_ratio, contact.friction
        return cls(way, *given, scene.wall.friction)


#: Counted in a slab at rest, for each of ``slab.MARGINS``.
LIMITED = "contacts of disks at rest whose tangential force is within a fraction of the Coulomb limit"


@record
class Rest:
    """The slab at rest."""

    contacts: float = column("contacts of disks at rest")
    level_force: float = column(
        f"mean normal force at rest of touching horizontal contacts in the central third {WEIGHTS}"
    )
    rest_mobilised: FloatArray = column(LIMITED, "margin")


@record
class Mobilized:
    """Which contacts of a slab at rest are fully mobilized, and which force it bears in what way."""

    polydispersity: float = column("polydispersity")
    realization: int = column("realization of the disorder")
    taps: int = column("how often the slab was tapped")
    tap_amplitude: float = column("largest acceleration of the box in a tap in g; 0 untapped")
    tap_duration: float = column("duration of a tap in sqrt(radius/g); 0 untapped")
    mobilized_part: FloatArray = column(f"part of the {LIMITED}", "margin")
    force: FloatArray = column(f"force of the event; nan if it does not come {WEIGHTS}", "name")


#: The events that are set against it; two peaks are asked of ordered slabs alone.
AGAINST = ("linear_range", "first_opening", "crossover")


@dataclass(frozen=True)
class Outcome:
    prepared: Prepared
    rest: Rest
    measured: xr.Dataset
    events: list[slab.Event]
    mobilized: Mobilized


def tapped(problem: Problem, rest: State, taps: int, amplitude: float, duration: float) -> State:
    """The equilibrium after a number of taps, each of which begins when the slab is at rest again.

    In the frame of the box, which moves as :class:`~.parameters.Taps` says, gravity goes from 1 to 1 + ``amplitude``,
    to 1 - ``amplitude`` and back to 1. ``duration`` of it all in sqrt(R/g), rounded to four times whole steps.

    Raises
    ------
    NotSettled, DynamicsError
        As of ``solvers.settle.settle``.
    """
    protocol = problem.scene.protocol
    stop = Stop(problem.plan.stop_energy, protocol.stop_rule, protocol.maximum_steps, problem.crossing_time)
    most, least = 1.0 + amplitude, 1.0 - amplitude
    for _ in range(taps):
        dynamics = Dynamics(problem, rest, protocol.integrator, resolve_time_step(problem))
        steps = round(0.25 * duration / dynamics.time_step)
        quarter = steps * dynamics.time_step
        dynamics.set_ramps(gravity=(1.0, most, quarter))
        dynamics.advance(steps)
        dynamics.set_ramps(gravity=(most, least, 2.0 * quarter))
        dynamics.advance(2 * steps)
        rest = settle(problem, dynamics.state(), PROTOCOL, stop, what="taps", gravity=(least, 1.0, quarter))
    return rest


def compute(
    way: str, scene: Scene, taps: tuple[int, float, float], forces: tuple[float, ...], asymmetry: float
) -> Outcome:
    """A slab settled as its ``scene`` says, tapped (number, amplitude, duration) and loaded by each of the forces."""
    problem = Problem.from_scene(scene)
    path = slab.LoadPath.of(scene, tapped(problem, rest_state(problem), *taps))
    states = path.through(forces)
    measures = slab.Measures(path)
    pairs = path.rest.pairs
    level = pairs.touching & (network.lattice_direction(path.rest) == network.HORIZONTAL) & measures.near
    level_force = float(pairs.normal_force[level].mean()) if level.any() else 0.0
    rest = Rest(float(pairs.touching.sum()), level_force, np.array(measures.mobilised(path.rest)))
    events = slab.locate(path, forces, slab.happenings(measures, states[0], asymmetry))
    packing, high = scene.packing.model_dump(), {event.name: event.high for event in events}
    if packing["polydispersity"]:
        high["crossover"] = np.nan
    part, against = rest.rest_mobilised / rest.contacts, np.array([high[name] for name in AGAINST])
    mobilized = Mobilized(packing["polydispersity"], packing["realization"], *taps, part, against)
    return Outcome(Prepared.of(way, scene), rest, slab.measured(measures, states), events, mobilized)


#: Of a slab, in the order in which they are stored: polydispersity, friction of its walls and disks, way and part by
#: their numbers, realization, and the number, amplitude and duration of taps.
Place = tuple[float, float, float, int, int, int, tuple[int, float, float]]


def tasks(parameters: Parameters) -> dict[Place, partial[Outcome]]:
    """A task for each part, way and realization, and for the taps of each."""
    return {
        (part.polydispersity, scene.wall.friction, scene.contact.friction, k, p, realization, taps): partial(
            compute, way.name, scene, taps, forces, parameters.asymmetry
        )
        for p, part in enumerate(parameters.parts)
        for forces in [tuple(force for force in parameters.forces if force <= part.to)]
        for k, way in enumerate(parameters.ways)
        if not part.ways or way.name in part.ways
        for realization in range(part.realizations)
        for scene in [_scene(parameters.base, part, realization).updated(way.changes)]
        for taps in part.tapped
    }


def _scene(base: Scene, part: Part, realization: int) -> Scene:
    walls = part.friction if part.walls == "rough" else 0.0
    scene = base.updated(material(part.polydispersity, realization, part.friction, walls))
    return scene.updated({"packing.lattice_constant": TOUCHING_LARGEST}) if part.polydispersity else scene


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response`` (case, force), nan above the last force of a case, ``events``, and ``mobilized``.

    The last one has the disordered and the tapped slabs too.
    """
    asked, forces = tasks(parameters), parameters.forces
    # the longest ramps of gravity take longest
    found = computed(asked, "prepared slabs", work=lambda place: asked[place].args[1].preparation.ramp_time)
    every = [found[place] for place in sorted(found)]
    cases = [one for one in every if not one.mobilized.polydispersity and not one.mobilized.taps]
    parts = [((k, slice(one.measured.sizes["state"])), one.measured) for k, one in enumerate(cases)]
    response = slab.measured_dataset(("case", "force"), parts, (len(cases), len(forces)))
    response = response.assign(table([one.rest for one in cases], "case").variables)
    response = response.assign_coords(axes(force=(forces, f"applied force {WEIGHTS}")))
    events = slab.events_dataset([event for one in cases for event in one.events])
    names = axes(name=(AGAINST, "event"), margin=(slab.MARGINS, "fraction below the Coulomb limit"))
    mobilized = table([one.mobilized for one in every], "case")
    datasets = {
        "response": response.assign_coords(_prepared(cases, "case")),
        "events": events.assign(_prepared([one for one in cases for _ in one.events], "event")),
        "mobilized": mobilized.assign(_prepared(every, "case")).assign_coords(names),
    }
    return labelled(datasets, parameters.base)


def _prepared(outcomes: Sequence[Outcome], dimension: str) -> Mapping[Any, xr.Variable]:
    return table([one.prepared for one in outcomes], dimension).variables
