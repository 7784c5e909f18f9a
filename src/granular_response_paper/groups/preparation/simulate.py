"""The same slab prepared in several ways: what a growing force does to each, and from which force on (Sec. V).

In the paper the packing relaxes under gravity, which acts at once (Sec. III.C); with friction the slab at rest
remembers how it came. Each way to prepare it is loaded by the same forces, on one path. Without friction rest is one
minimum of the energy, and one way stands for all. How many contacts are fully mobilized at rest, and where the linear
range ends, is measured on disordered slabs too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.preparation.parameters import Parameters, Part
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


@record
class Rest:
    """The slab at rest."""

    contacts: float = column("contacts of disks at rest")
    level_force: float = column(
        f"mean normal force at rest of touching horizontal contacts in the central third {WEIGHTS}"
    )
    rest_mobilised: FloatArray = column(
        "contacts of disks at rest whose tangential force is within a fraction of the Coulomb limit", "margin"
    )


@record
class Mobilized:
    """Which contacts of a slab at rest are fully mobilized, and which force it bears in what way."""

    polydispersity: float = column("polydispersity")
    realization: int = column("realization of the disorder")
    mobilized_part: FloatArray = column(
        "part of the contacts of disks at rest whose tangential force is within a fraction of the Coulomb limit",
        "margin",
    )
    force: FloatArray = column(f"force of the event; nan if it does not come {WEIGHTS}", "name")


#: The events that are set against it; two peaks are asked of ordered slabs alone.
AGAINST = ("linear_range", "first_opening", "crossover")


@dataclass(frozen=True)
class Outcome:
    prepared: Prepared
    rest: Rest
    measured: xr.Dataset
    events: list[slab.Event]

    def mobilized(self, polydispersity: float, realization: int) -> Mobilized:
        high = {event.name: event.high for event in self.events}
        if polydispersity:
            high["crossover"] = np.nan
        part = self.rest.rest_mobilised / self.rest.contacts
        return Mobilized(polydispersity, realization, part, np.array([high[name] for name in AGAINST]))


def compute(way: str, scene: Scene, forces: tuple[float, ...], asymmetry: float) -> Outcome:
    """A slab settled as its ``scene`` says and loaded by each of the forces."""
    path = slab.LoadPath.of(scene)
    states = path.through(forces)
    measures = slab.Measures(path)
    pairs = path.rest.pairs
    level = pairs.touching & (network.lattice_direction(path.rest) == network.HORIZONTAL) & measures.near
    level_force = float(pairs.normal_force[level].mean()) if level.any() else 0.0
    return Outcome(
        Prepared.of(way, scene),
        Rest(float(pairs.touching.sum()), level_force, np.array(measures.mobilised(path.rest))),
        slab.measured(measures, states),
        slab.locate(path, forces, slab.happenings(measures, states[0], asymmetry)),
    )


#: Of a slab: polydispersity, friction of its walls and disks, way and part by their numbers, and realization.
Place = tuple[float, float, float, int, int, int]


def tasks(parameters: Parameters) -> dict[Place, partial[Outcome]]:
    """A task for each part, way and realization."""
    return {
        (part.polydispersity, scene.wall.friction, scene.contact.friction, k, p, realization): partial(
            compute,
            way.name,
            scene,
            tuple(force for force in parameters.forces if force <= part.to),
            parameters.asymmetry,
        )
        for p, part in enumerate(parameters.parts)
        for k, way in enumerate(parameters.ways)
        if not part.ways or way.name in part.ways
        for realization in range(part.realizations)
        for scene in [_scene(parameters.base, part, realization).updated(way.changes)]
    }


def _scene(base: Scene, part: Part, realization: int) -> Scene:
    rough = part.walls == "rough"
    changes: dict[str, Any] = {
        "contact.friction": part.friction, "wall.friction": part.friction if rough else 0.0
    }  # fmt: skip
    if part.polydispersity:
        changes |= {
            "packing.polydispersity": part.polydispersity,
            "packing.lattice_constant": TOUCHING_LARGEST,
            "packing.realization": realization,
        }
    return base.updated(changes)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response`` (case, force), nan above the last force of a case, ``events``, and ``mobilized``.

    The last one has the disordered slabs too.
    """
    asked = tasks(parameters)
    # the longest ramps of gravity take longest
    found = computed(asked, "prepared slabs", work=lambda place: asked[place].args[1].preparation.ramp_time)
    places = sorted(found)
    outcomes = [found[place] for place in places if not place[0]]
    mobilized = table([found[place].mobilized(place[0], place[-1]) for place in places], "case")
    mobilized = mobilized.assign(table([found[place].prepared for place in places], "case").variables).assign_coords(
        axes(name=(AGAINST, "event"), margin=(slab.MARGINS, "fraction below the Coulomb limit"))
    )
    datasets = {
        "response": _response(outcomes, parameters.forces), "events": _events(outcomes), "mobilized": mobilized
    }  # fmt: skip
    return labelled(datasets, parameters.base)


def _response(outcomes: Sequence[Outcome], forces: Sequence[float]) -> xr.Dataset:
    parts = [((k, slice(one.measured.sizes["state"])), one.measured) for k, one in enumerate(outcomes)]
    dataset = slab.measured_dataset(("case", "force"), parts, (len(outcomes), len(forces)))
    return (
        dataset.assign(table([one.rest for one in outcomes], "case").variables)
        .assign_coords(axes(force=(forces, f"applied force {WEIGHTS}")))
        .assign_coords(table([one.prepared for one in outcomes], "case").variables)
    )


def _events(outcomes: Sequence[Outcome]) -> xr.Dataset:
    """The events of all cases; the labels of their case stand beside them."""
    dataset = slab.events_dataset([event for one in outcomes for event in one.events])
    return dataset.assign(table([one.prepared for one in outcomes for _ in one.events], "event").variables)
