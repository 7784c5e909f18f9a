"""The same slab prepared in several ways: what a growing force does to each, and from which force on (Sec. V).

In the paper the packing relaxes under gravity, which acts at once (Sec. III.C); with friction the slab at rest
remembers how it came. Each way to prepare it is loaded by the same forces, on one path. Without friction rest is one
minimum of the energy, and one way stands for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.store.result import FORCE, variable
from granular_response.sweeps.tasks import run_tasks
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.preparation.parameters import Parameters, Part


@dataclass(frozen=True)
class Task:
    """One slab: its preparation and its friction are in ``scene``."""

    way: str
    scene: Scene
    forces: tuple[float, ...]
    asymmetry: float

    def run(self) -> Outcome:
        """The slab settled and loaded by each of the forces."""
        path = slab.LoadPath.of(self.scene)
        states = path.through(self.forces)
        measures = slab.Measures(path)
        asked = slab.happenings(measures, states[0], self.asymmetry)
        pairs = path.rest.pairs
        level = pairs.touching & (network.lattice_direction(path.rest) == network.HORIZONTAL) & measures.near
        return Outcome(
            self,
            slab.measured(measures, states),
            [slab.locate(name, path, self.forces, what) for name, what in asked.items()],
            float(pairs.normal_force[level].mean()) if level.any() else 0.0,
            measures.mobilised(path.rest),
        )


@dataclass(frozen=True)
class Outcome:
    task: Task
    measured: xr.Dataset
    events: list[slab.Event]
    level_force: float  #: mean normal force of horizontal contacts at rest
    rest_mobilised: list[int]  #: contacts of disks near the Coulomb limit at rest, by margin


def tasks(parameters: Parameters) -> list[Task]:
    """A task for each part and way; the longest ramps of gravity first, which take longest."""
    found = [
        Task(
            way.name,
            _scene(parameters.base, part).updated(way.changes),
            tuple(force for force in parameters.forces if force <= part.to),
            parameters.asymmetry,
        )
        for part in parameters.parts
        for way in parameters.ways
        if not part.ways or way.name in part.ways
    ]
    return sorted(found, key=lambda task: -task.scene.preparation.ramp_time)


def _scene(base: Scene, part: Part) -> Scene:
    rough = part.walls == "rough"
    return base.updated({"contact.friction": part.friction, "wall.friction": part.friction if rough else 0.0})


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response`` (case, force), nan above the last force of a case, and ``events``."""
    outcomes = run_tasks(tasks(parameters), what="prepared slabs")
    order = [way.name for way in parameters.ways]
    outcomes = sorted(outcomes, key=lambda o: (*_walls_and_friction(o), order.index(o.task.way)))
    return labelled({"response": _response(outcomes, parameters.forces), "events": _events(outcomes)}, parameters.base)


def _walls_and_friction(outcome: Outcome) -> tuple[float, float]:
    scene = outcome.task.scene
    return scene.wall.friction, scene.contact.friction


def _response(outcomes: Sequence[Outcome], forces: Sequence[float]) -> xr.Dataset:
    parts = [((k, slice(len(o.task.forces))), o.measured) for k, o in enumerate(outcomes)]
    dataset = slab.measured_dataset(("case", "force"), parts, (len(outcomes), len(forces)))
    dataset["level_force"] = variable(
        "case",
        [o.level_force for o in outcomes],
        f"mean normal force at rest of touching horizontal contacts in the central third {FORCE}",
    )
    dataset["rest_mobilised"] = variable(
        ("case", "margin"),
        [o.rest_mobilised for o in outcomes],
        "contacts of disks at rest whose tangential force is within a fraction of the Coulomb limit",
    )
    axis = variable("force", forces, f"applied force {FORCE}")
    return dataset.assign_coords({"force": axis, **_labels("case", outcomes, [1] * len(outcomes))})


def _events(outcomes: Sequence[Outcome]) -> xr.Dataset:
    """The events of all cases; the labels of their case stand beside them."""
    dataset = slab.events_dataset([event for o in outcomes for event in o.events])
    return dataset.assign(_labels("event", outcomes, [len(o.events) for o in outcomes]))


def _labels(dimension: str, outcomes: Sequence[Outcome], repeats: Sequence[int]) -> dict[str, xr.Variable]:
    scenes = [o.task.scene for o in outcomes]
    columns = {
        "way": (np.array([o.task.way for o in outcomes]), "how the slab was prepared"),
        "gravity": (np.array([scene.preparation.gravity for scene in scenes]), "how gravity came"),
        "ramp_time": (
            np.array([scene.preparation.ramp_time for scene in scenes]),
            "time over which slow gravity grows in sqrt(radius/g)",
        ),
        "damping_ratio": (np.array([scene.contact.damping_ratio for scene in scenes]), "damping over critical damping"),
        "friction": (np.array([scene.contact.friction for scene in scenes]), "coefficient of friction between disks"),
        "wall_friction": (np.array([scene.wall.friction for scene in scenes]), "coefficient of friction of walls"),
    }
    return {name: variable(dimension, np.repeat(values, repeats), text) for name, (values, text) in columns.items()}
