"""Where the dynamics and the solvers stop working, and that they say so.

``time_step_*``: which time steps settle, cycle or blow up, against the predicted limit. ``drift``, ``collisions``,
``rolling``: energy and motion against what is known in closed form. ``rounding``: rest states disturbed in their last
digits. ``random_scenes``: what became of random scenes, each result checked from its positions alone.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.scene.protocol import Integrator
from granular_response.solve import Problem
from granular_response.solve.timestep import stability_limit
from granular_response.store.result import FORCE, variable
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.stability.parameters import (
    Collisions,
    Drift,
    Parameters,
    RandomScenes,
    Rolling,
    Rounding,
    TimeSteps,
)
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
    "load": ("loads", f"applied force {FORCE}"),
}


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``time_step_AXIS`` for each of ``time_steps.axes``, ``drift``, ``collisions``, ``rolling``, ``rounding``
    and ``random_scenes``.
    """
    seed = parameters.seed
    plans = [
        _time_steps(parameters.time_steps, seed),
        _drift(parameters.drift, seed),
        _collisions(parameters.collisions),
        _rolling(parameters.rolling),
        _rounding(parameters.rounding, seed),
        _random_scenes(parameters.random_scenes, seed),
    ]
    tasks: list[list[Task]] = [next(plan) for plan in plans]
    results = iter(map_tasks(_run, [task for several in tasks for task in several], what="stability trials"))
    datasets: dict[str, xr.Dataset] = {}
    for plan, several in zip(plans, tasks, strict=True):
        datasets |= plan.send([next(results) for _ in several])
    return labelled(datasets)


Task = Callable[[], Any]


def _run(task: Task) -> Any:
    return task()


#: Yields its tasks, is sent what they hand back, and yields its datasets.
Plan = Generator[Any, list[Any], None]


def _time_steps(parameters: TimeSteps, seed: int) -> Plan:
    base, ratios, steps = parameters.scene, parameters.ratios, parameters.steps
    integrators, axes = parameters.integrators, parameters.axes
    tasks: list[Task] = []
    for name, values in axes.items():
        for value in values:
            if name == "load":
                changes: dict[str, Any] = {"loads": [{"disk": "top-centre", "force": [0.0, -value]}] if value else []}
            else:
                changes = {AXES[name][0]: value}
            scene = time_steps.scene_of(base, changes)
            tasks.append(time_steps.StepTrial(scene, integrators, ratios, steps, seed).run)

    found: list[list[tuple[float, list[int]]]] = yield tasks
    datasets = {}
    rest = iter(found)
    for name, values in axes.items():
        shape = (len(integrators), len(values))
        of_values = [next(rest) for _ in values]
        several = [of_value[row] for row in range(len(integrators)) for of_value in of_values]
        datasets[f"time_step_{name}"] = xr.Dataset(
            {
                "limit": variable(
                    ("integrator", name),
                    np.array([limit for limit, _ in several]).reshape(shape),
                    "predicted largest stable time step in sqrt(radius/g)",
                ),
                "outcome": variable(
                    ("integrator", name, "ratio"),
                    np.array([outcomes for _, outcomes in several], np.int8).reshape(*shape, len(ratios)),
                    "what becomes of a kick: "
                    + ", ".join(f"{code} {text}" for code, text in enumerate(time_steps.OUTCOMES)),
                ),
            },
            coords={
                "integrator": variable("integrator", integrators, "integrator"),
                name: variable(name, values, AXES[name][1]),
                "ratio": variable("ratio", ratios, "time step over the predicted limit"),
            },
        )
    yield datasets


@dataclass(frozen=True)
class DriftTask:
    """An undamped system in motion: a disk that bounces on the floor, or a slab at rest that is kicked.

    The kick is strong enough for contacts to open and slide. Springs are ahead of positions by half a time step, so
    in a feeble motion about large forces the total energy cannot be read off.
    """

    scene: Scene
    system: str
    integrator: str
    part: float
    time: float
    kick: float
    seed: int

    def run(self) -> tuple[np.ndarray, np.ndarray]:
        undamped = self.scene.updated({"contact.damping_ratio": 0.0, "wall.damping_ratio": 0.0})
        if self.system == "bouncing disk":
            still = np.zeros(1)
            problem, state = closed_forms.free_disks(undamped, np.array([(0.0, 1.5)]), np.zeros((1, 2)), still)
        else:
            problem, state, _ = time_steps.prepared(Problem.from_scene(undamped))
            state = time_steps.kick(problem, state, self.seed, self.kick)
        step = self.part * stability_limit(problem, "verlet")
        times, change = closed_forms.energy_change(problem, state, self.integrator, step, self.time)
        return times, change / (0.5 if self.system == "bouncing disk" else closed_forms.kinetic_energy(state, problem))


def _drift(parameters: Drift, seed: int) -> Plan:
    systems = {
        "bouncing disk": (0.0, parameters.time),
        "slab": (0.0, parameters.time),
        "slab with friction": (parameters.friction, parameters.friction_time),
    }
    base, integrators = parameters.scene, parameters.integrators
    part, kick = parameters.part_of_limit, parameters.kick
    tasks: list[Task] = [
        DriftTask(base.updated({"contact.friction": mu}), system, name, part, time, kick, seed).run
        for system, (mu, time) in systems.items()
        for name in integrators
    ]

    found: list[tuple[np.ndarray, np.ndarray]] = yield tasks
    shape = (len(systems), len(integrators), -1)
    dims = ("system", "integrator", "reading")
    dataset = xr.Dataset(
        {
            "time": variable(dims, np.array([t for t, _ in found]).reshape(shape), "time in sqrt(radius/g)"),
            "energy_change": variable(
                dims,
                np.array([e for _, e in found]).reshape(shape),
                "change of the total energy of an undamped system, per energy that it moves with",
            ),
        },
        coords={
            "system": variable("system", list(systems), "what moves"),
            "integrator": variable("integrator", integrators, "integrator"),
        },
    )
    yield {"drift": dataset}


def _collisions(parameters: Collisions) -> Plan:
    bodies, laws = ["floor", "disk"], ["cut", "literal"]
    damping, frictions, step = parameters.damping_ratios, parameters.frictions, parameters.time_step
    angles, spins = parameters.angles, parameters.spins
    tasks: list[Task] = []
    for body in bodies:
        for law in laws:
            for ratio in damping:
                for mu in frictions:
                    changes = {"contact.friction": mu, "wall.friction": mu, "contact.damping_ratio": ratio}
                    scene = Scene().updated({**changes, "protocol.friction_law": law, "loads": []})
                    tasks.append(CollisionTask(scene, angles, spins, step, body == "disk").run)

    found: list[list[list[float]]] = yield tasks
    shape = (len(bodies), len(laws), len(damping), len(frictions), len(angles), len(spins))
    dims = ("body", "friction_law", "damping_ratio", "friction", "angle", "spin")
    dataset = xr.Dataset(
        {
            "energy_ratio": variable(
                dims, np.array(found).reshape(shape), "kinetic energy after a collision over that before"
            )
        },
        coords={
            "body": variable("body", bodies, "what the disk hits"),
            "friction_law": variable("friction_law", laws, "protocol.friction_law"),
            "damping_ratio": variable("damping_ratio", damping, AXES["damping_ratio"][1]),
            "friction": variable("friction", frictions, "coefficient of friction"),
            "angle": variable("angle", angles, "angle of incidence from grazing in degrees"),
            "spin": variable("spin", spins, "spin of the hitting disk, rim speed over speed"),
        },
    )
    yield {"collisions": dataset}


@dataclass(frozen=True)
class CollisionTask:
    """Collisions at all angles and spins under one contact law."""

    scene: Scene
    angles: tuple[float, ...]
    spins: tuple[float, ...]
    step: float
    pair: bool

    def run(self) -> list[list[float]]:
        return [
            [closed_forms.collision(self.scene, angle, spin, self.step, pair=self.pair) for spin in self.spins]
            for angle in self.angles
        ]


def _rolling(parameters: Rolling) -> Plan:
    friction, step, starts = parameters.friction, parameters.time_step, parameters.starts
    scene = Scene().updated({"wall.friction": friction, "loads": []})
    times = [1.5 * abs(speed + spin) / (3.0 * friction) for speed, spin in starts]
    tasks: list[Task] = [
        partial(closed_forms.sliding_to_rolling, scene, speed, spin, step, time)
        for (speed, spin), time in zip(starts, times, strict=True)
    ]

    found: list[tuple[np.ndarray, ...]] = yield tasks
    exact = [closed_forms.rolling_speed(t, friction, *start) for (t, _, _), start in zip(found, starts, strict=True)]
    dims = ("start", "reading")
    dataset = xr.Dataset(
        {
            "time": variable(dims, np.stack([t for t, _, _ in found]), "time in sqrt(radius/g)"),
            "velocity": variable(dims, np.stack([v for _, v, _ in found]), "velocity of the disk, x"),
            "rim_speed": variable(dims, np.stack([r for _, _, r in found]), "rim speed, positive for rolling along x"),
            "exact_velocity": variable(dims, np.stack([v for v, _ in exact]), "velocity in closed form"),
            "exact_rim_speed": variable(dims, np.stack([r for _, r in exact]), "rim speed in closed form"),
        },
        coords={
            "speed": variable("start", [v for v, _ in starts], "velocity at first"),
            "spin": variable("start", [w for _, w in starts], "spin at first, counter-clockwise"),
        },
    )
    dataset["friction"] = variable((), friction, "coefficient of friction of the floor")
    yield {"rolling": dataset}


def _rounding(parameters: Rounding, seed: int) -> Plan:
    cases, size, kicks = parameters.cases, parameters.displacement, parameters.kicks
    tasks: list[Task] = [partial(disturb, scene, size, range(seed, seed + kicks)) for scene in parameters.scenes]
    texts = {
        "rest_change": "largest displacement left after the disturbed rest state is back in equilibrium, in mean radii",
        "response_change": "largest change of the floor response by the disturbance, per its largest value",
        "excess_coordination": "contacts per bearing disk beyond the isostatic number",
        "loose_disks": "disks with fewer than two contacts",
        "negative_modes": "negative modes of the rest state",
        "lost": "equilibria that the path has lost",
    }

    several: list[list[Disturbed]] = yield tasks
    found = [one for ones in several for one in ones]
    dataset = xr.Dataset(
        {
            name: variable(
                ("case", "kick"), np.array([getattr(f, name) for f in found]).reshape(len(cases), kicks), text
            )
            for name, text in texts.items()
        },
        coords={"case": variable("case", list(cases), "packing and load")},
    )
    dataset["displacement"] = variable((), size, "largest displacement of the rest state, in mean radii")
    yield {"rounding": dataset}


def _random_scenes(parameters: RandomScenes, seed: int) -> Plan:
    number, chunk, steps = parameters.number, parameters.chunk, parameters.maximum_steps
    starts = range(0, number, chunk)
    tasks: list[Task] = [partial(_random_chunk, steps, seed, begin, min(begin + chunk, number)) for begin in starts]

    found: list[list[random_scenes.Trial]] = yield tasks
    trials = [trial for several in found for trial in several]
    texts = {
        "friction": "coefficient of friction between disks",
        "disks": "number of disks, 0 after an error",
        "states": "states that were checked",
        "force_residual": "largest unbalanced force, summed anew from positions, in mean disk weights",
        "torque_residual": "largest unbalanced torque",
        "coulomb_excess": "largest friction force beyond Coulomb's limit",
        "twin_difference": "largest difference of floor responses to the mirrored twin, over the load",
    }
    dataset = xr.Dataset(
        {key: variable("scene", [getattr(t, key) for t in trials], text) for key, text in texts.items()}
    )
    words = {
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
    yield {"random_scenes": dataset}


def _random_chunk(steps: int, seed: int, begin: int, end: int) -> list[random_scenes.Trial]:
    return [random_scenes.run(steps, seed, index) for index in range(begin, end)]
