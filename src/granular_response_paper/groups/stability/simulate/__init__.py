"""Where the dynamics and the solvers stop working, and that they say so.

``time_step_*``: which time steps settle, cycle or blow up, against the predicted limit. ``drift``, ``collisions``,
``rolling``: energy and motion against what is known in closed form. ``rounding``: rest states disturbed in their last
digits. ``random_scenes``: what became of random scenes, each result checked from its positions alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import chain
from typing import Any

import xarray as xr

from granular_response.scene import Scene
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.stability import parameters as given
from granular_response_paper.records import axes, places, table, table_along, variables
from granular_response_paper.tasks import computed
from granular_response_paper.trials import closed_forms, random_scenes, time_steps
from granular_response_paper.trials.rounding import Disturbed, disturb

#: Axes of the time-step maps: what each one changes in the scene, and what it is.
AXES: dict[str, tuple[str, str]] = {
    "normal_stiffness": ("contact.normal_stiffness", "normal stiffness in mean disk weights per mean radius"),
    "stiffness_ratio": ("contact.stiffness_ratio", "tangential over normal stiffness"),
    "damping_ratio": ("contact.damping_ratio", "dashpot over its critical value"),
    "friction": ("contact.friction", "coefficient of friction between disks"),
    "wall_friction": ("wall.friction", "coefficient of friction of the walls"),
    "wall_stiffness": ("wall.normal_stiffness", "normal stiffness of walls in mean disk weights per mean radius"),
    "polydispersity": ("packing.polydispersity", "polydispersity"),
    "load": ("loads", f"applied force {WEIGHTS}"),
}


#: What the disk of a collision hits, and by which friction law.
BODIES, LAWS = ("floor", "disk"), ("cut", "literal")

#: Of one study: its tasks by their places, and what makes the datasets of what these find.
Study = tuple[Mapping[Any, Callable[[], Any]], Callable[[dict[Any, Any]], dict[str, xr.Dataset]]]


def simulate(parameters: given.Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``time_step_AXIS`` for each of ``time_steps.axes``, ``drift``, ``collisions``, ``rolling``, ``rounding``
    and ``random_scenes``.
    """
    asked, seed = parameters, parameters.seed
    studies = (
        _time_steps(asked.time_steps, seed),
        _drift(asked.drift, seed),
        _collisions(asked.collisions),
        _rolling(asked.rolling),
        _rounding(asked.rounding, seed),
        _random_scenes(asked.random_scenes, seed),
    )
    tasks = {(k, place): task for k, (several, _) in enumerate(studies) for place, task in several.items()}
    done = computed(tasks, "stability trials")
    made: dict[str, xr.Dataset] = {}
    for k, (several, datasets) in enumerate(studies):
        made |= datasets({place: done[k, place] for place in several})
    return labelled(made)


def _time_steps(asked: given.TimeSteps, seed: int) -> Study:
    """By the name of an axis and the place on it."""
    tasks = {}
    for name, values in asked.axes.items():
        for k, value in enumerate(values):
            loads = [{"disk": "top-centre", "force": [0.0, -value]}] if value else []
            changes = {AXES[name][0]: loads if name == "load" else value}
            scene = asked.scene.updated({**changes, "protocol.time_step": "auto"})  # safe to come to rest with
            tasks[name, k] = partial(time_steps.tried, scene, asked.integrators, asked.ratios, asked.steps, seed)

    def along(name: given.Axis, found: dict[Any, list[time_steps.Steps]]) -> xr.Dataset:
        axis, ratio = (asked.axes[name], AXES[name][1]), (asked.ratios, "time step over the predicted limit")
        several = {(i, k): one for k in range(len(axis[0])) for i, one in enumerate(found[name, k])}
        return table_along(several, integrator=(asked.integrators, "integrator"), **{name: axis}, ratio=ratio)

    return tasks, lambda found: {f"time_step_{name}": along(name, found) for name in asked.axes}


def _drift(asked: given.Drift, seed: int) -> Study:
    systems = {  # friction and duration by what moves
        "bouncing disk": (0.0, asked.time),
        "slab": (0.0, asked.time),
        "slab with friction": (asked.friction, asked.friction_time),
    }
    tasks = {}
    for place, ((system, (mu, time)), name) in places(list(systems.items()), asked.integrators):
        scene = asked.scene.updated({"contact.friction": mu})
        tasks[place] = partial(closed_forms.drift, scene, system, name, asked.part_of_limit, time, asked.kick, seed)
    along = {"system": (systems, "what moves"), "integrator": (asked.integrators, "integrator")}
    return tasks, lambda found: {"drift": table_along(found, **along)}


def _collisions(asked: given.Collisions) -> Study:
    tasks = {}
    for place, (body, law, ratio, mu) in places(BODIES, LAWS, asked.damping_ratios, asked.frictions):
        changes = {"contact.friction": mu, "wall.friction": mu, "contact.damping_ratio": ratio}
        scene = Scene().updated({**changes, "protocol.friction_law": law, "loads": []})
        tasks[place] = partial(closed_forms.collide, scene, asked.angles, asked.spins, asked.time_step, body)
    along = {
        "body": (BODIES, "what the disk hits"),
        "friction_law": (LAWS, "protocol.friction_law"),
        "damping_ratio": (asked.damping_ratios, AXES["damping_ratio"][1]),
        "friction": (asked.frictions, "coefficient of friction"),
        "angle": (asked.angles, "angle of incidence from grazing in degrees"),
        "spin": (asked.spins, "spin of the hitting disk, rim speed over speed"),
    }
    return tasks, lambda found: {"collisions": table_along(found, **along)}


def _rolling(asked: given.Rolling) -> Study:
    tasks = {
        (k,): partial(closed_forms.roll, asked.friction, *start, asked.time_step)
        for k, start in enumerate(asked.starts)
    }
    friction = variable((), asked.friction, "coefficient of friction of the floor")
    speed, spin = zip(*asked.starts, strict=True)
    starts = variables(
        speed=("start", speed, "velocity at first"), spin=("start", spin, "spin at first, counter-clockwise")
    )
    return tasks, lambda found: {"rolling": table(found, "start").assign_coords(starts).assign(friction=friction)}


def _rounding(asked: given.Rounding, seed: int) -> Study:
    seeds = range(seed, seed + asked.kicks)
    tasks = {(k,): partial(disturb, scene, asked.displacement, seeds) for k, scene in enumerate(asked.scenes)}
    size = variable((), asked.displacement, "largest displacement of the rest state, in mean radii")

    def dataset(found: dict[Any, list[Disturbed]]) -> xr.Dataset:
        each = {(*case, k): one for case, several in found.items() for k, one in enumerate(several)}
        cases = axes(case=(asked.cases, "packing and load"))
        return table(each, "case", "kick").assign_coords(cases).assign(displacement=size)

    return tasks, lambda found: {"rounding": dataset(found)}


def _random_scenes(asked: given.RandomScenes, seed: int) -> Study:
    numbers, starts = range(asked.number), range(0, asked.number, asked.chunk)
    tasks = {k: partial(random_scenes.several, asked.maximum_steps, seed, numbers[k : k + asked.chunk]) for k in starts}
    return tasks, lambda found: {"random_scenes": random_scenes.dataset([*chain(*found.values())])}
