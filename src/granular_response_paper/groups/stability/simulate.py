"""Where the dynamics and the solvers stop working, and that they say so.

``time_step_*``: which time steps settle, cycle or blow up, against the predicted limit. ``drift``, ``collisions``,
``rolling``: energy and motion against what is known in closed form. ``rounding``: rest states disturbed in their last
digits. ``random_scenes``: what became of random scenes, each result checked from its positions alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import chain
from typing import Any, get_args

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.scene.protocol import Integrator
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import stability_limit
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.stability import parameters as given
from granular_response_paper.records import axes, column, record, table, table_along, variables
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

    def datasets(found: dict[Any, list[time_steps.Steps]]) -> dict[str, xr.Dataset]:
        made = {}
        for name, values in asked.axes.items():
            several = {(i, k): one for k in range(len(values)) for i, one in enumerate(found[name, k])}
            made[f"time_step_{name}"] = table_along(
                several,
                integrator=(asked.integrators, "integrator"),
                **{name: (values, AXES[name][1])},
                ratio=(asked.ratios, "time step over the predicted limit"),
            )
        return made

    return tasks, datasets


@record
class Drifted:
    time: FloatArray = column("time in sqrt(radius/g)", "reading")
    energy_change: FloatArray = column(
        "change of the total energy of an undamped system, per energy that it moves with", "reading"
    )


def drift(scene: Scene, system: str, integrator: str, part: float, time: float, kick: float, seed: int) -> Drifted:
    """An undamped system in motion: a disk that bounces on the floor, or a slab at rest that is kicked.

    The kick is strong enough for contacts to open and slide. Springs are ahead of positions by half a time step, so
    in a feeble motion about large forces the total energy cannot be read off.
    """
    undamped = scene.updated({"contact.damping_ratio": 0.0, "wall.damping_ratio": 0.0})
    if system == "bouncing disk":
        still = np.zeros(1)
        problem, state = closed_forms.free_disks(undamped, np.array([(0.0, 1.5)]), np.zeros((1, 2)), still)
    else:
        problem, state, _ = time_steps.prepared(Problem.from_scene(undamped))
        state = time_steps.kick(problem, state, seed, kick)
    step = part * stability_limit(problem, "verlet")
    times, change = closed_forms.energy_change(problem, state, integrator, step, time)
    return Drifted(times, change / (0.5 if system == "bouncing disk" else closed_forms.kinetic_energy(state, problem)))


def _drift(asked: given.Drift, seed: int) -> Study:
    systems = {  # friction and duration by what moves
        "bouncing disk": (0.0, asked.time),
        "slab": (0.0, asked.time),
        "slab with friction": (asked.friction, asked.friction_time),
    }
    tasks = {}
    for s, (system, (mu, time)) in enumerate(systems.items()):
        scene = asked.scene.updated({"contact.friction": mu})
        for i, name in enumerate(asked.integrators):
            tasks[s, i] = partial(drift, scene, system, name, asked.part_of_limit, time, asked.kick, seed)
    along = {"system": (systems, "what moves"), "integrator": (asked.integrators, "integrator")}
    return tasks, lambda found: {"drift": table_along(found, **along)}


@record
class Collided:
    energy_ratio: FloatArray = column("kinetic energy after a collision over that before", "angle", "spin")


def collide(scene: Scene, angles: tuple[float, ...], spins: tuple[float, ...], step: float, body: str) -> Collided:
    """Collisions at all angles and spins under one contact law."""
    pair = body == "disk"
    ratios = [[closed_forms.collision(scene, angle, spin, step, pair=pair) for spin in spins] for angle in angles]
    return Collided(np.array(ratios))


def _collisions(asked: given.Collisions) -> Study:
    tasks = {}
    for b, k, d, f in np.ndindex(len(BODIES), len(LAWS), len(asked.damping_ratios), len(asked.frictions)):
        mu, ratio = asked.frictions[f], asked.damping_ratios[d]
        changes = {"contact.friction": mu, "wall.friction": mu, "contact.damping_ratio": ratio}
        scene = Scene().updated({**changes, "protocol.friction_law": LAWS[k], "loads": []})
        tasks[b, k, d, f] = partial(collide, scene, asked.angles, asked.spins, asked.time_step, BODIES[b])
    along = {
        "body": (BODIES, "what the disk hits"),
        "friction_law": (LAWS, "protocol.friction_law"),
        "damping_ratio": (asked.damping_ratios, AXES["damping_ratio"][1]),
        "friction": (asked.frictions, "coefficient of friction"),
        "angle": (asked.angles, "angle of incidence from grazing in degrees"),
        "spin": (asked.spins, "spin of the hitting disk, rim speed over speed"),
    }
    return tasks, lambda found: {"collisions": table_along(found, **along)}


@record
class Rolled:
    time: FloatArray = column("time in sqrt(radius/g)", "reading")
    velocity: FloatArray = column("velocity of the disk, x", "reading")
    rim_speed: FloatArray = column("rim speed, positive for rolling along x", "reading")
    exact_velocity: FloatArray = column("velocity in closed form", "reading")
    exact_rim_speed: FloatArray = column("rim speed in closed form", "reading")


def roll(friction: float, speed: float, spin: float, step: float) -> Rolled:
    """A disk thrown along the floor, until it has rolled for a while."""
    scene = Scene().updated({"wall.friction": friction, "loads": []})
    time = 1.5 * abs(speed + spin) / (3.0 * friction)
    times, velocity, rim_speed = closed_forms.sliding_to_rolling(scene, speed, spin, step, time)
    return Rolled(times, velocity, rim_speed, *closed_forms.rolling_speed(times, friction, speed, spin))


def _rolling(asked: given.Rolling) -> Study:
    tasks = {(k,): partial(roll, asked.friction, *start, asked.time_step) for k, start in enumerate(asked.starts)}
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

    def datasets(found: dict[Any, list[Disturbed]]) -> dict[str, xr.Dataset]:
        each = {(*case, k): one for case, several in found.items() for k, one in enumerate(several)}
        dataset = table(each, "case", "kick").assign_coords(axes(case=(asked.cases, "packing and load")))
        return {"rounding": dataset.assign(displacement=size)}

    return tasks, datasets


def _random_scenes(asked: given.RandomScenes, seed: int) -> Study:
    tasks = {
        (begin,): partial(_random_chunk, asked.maximum_steps, seed, begin, min(begin + asked.chunk, asked.number))
        for begin in range(0, asked.number, asked.chunk)
    }
    return tasks, lambda found: {"random_scenes": _random_scenes_dataset([*chain(*found.values())])}


def _random_chunk(steps: int, seed: int, begin: int, end: int) -> list[random_scenes.Trial]:
    return [random_scenes.run(steps, seed, index) for index in range(begin, end)]


def _random_scenes_dataset(trials: list[random_scenes.Trial]) -> xr.Dataset:
    dataset = table(trials, "scene")
    words: dict[str, tuple[tuple[str, ...], str]] = {
        "outcome": (random_scenes.OUTCOMES, "what became of the scene"),
        "kind": (("slab", "pile", "file"), "packing"),
        "method": (random_scenes.METHODS, "method asked for"),
        "integrator": (get_args(Integrator), "integrator"),
    }
    for name, (values, text) in words.items():
        codes = np.array([values.index(getattr(t, name)) for t in trials], np.int8)
        legend = ", ".join(f"{code} {value}" for code, value in enumerate(values))
        dataset[name] = variable("scene", codes, f"{text}: {legend}")
    # what a wrong result was, for whoever has to look at it
    wrong = [f"{k}: {t.message}" for k, t in enumerate(trials) if t.outcome == "wrong"]
    dataset.attrs["wrong"] = "; ".join(wrong)
    return dataset
