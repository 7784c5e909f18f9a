"""What the paper says about its numerics, measured: claims N1 to N7 (Secs. III, III.B and III.C).

``stop_energy`` is the error that a stopping energy leaves in the floor forces; ``restart`` the kinetic energy after
a static finish; ``at_rest`` the other criteria of rest, ``swing`` how disks would move on; ``time_step`` and
``integrators`` responses to compare; ``damping`` the time to rest against the damping ratio; ``disorder`` what an early
stop costs averages over disordered slabs. All but the last are runs of the dynamics on the default slab, without the
static finish unless that is what is measured.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import floor_disks, floor_force, floor_response, smoothed_response
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.timestep import resolve_time_step, stability_limit
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import Task, run_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.numerics.parameters import Parameters

#: Steps between two readings of the kinetic energy of a restarted state.
READ_EVERY = 100

#: When the kinetic energy is below the limit: the first time that it is, or all along a slow swing.
STOP_RULES = ("instantaneous", "envelope")


@dataclass(frozen=True)
class StopTask:
    """Rest and one load by dynamics alone, stopped at several energies, against the statically finished states."""

    scene: Scene
    stop_energies: tuple[float, ...]

    def run(self) -> list[dict[str, float]]:
        """The errors at each stopping energy; the finish starts from the smallest."""
        finished = self.scene.updated({"protocol.stop_kinetic_energy": min(self.stop_energies)})
        exact_rest, exact_loaded, _ = rest_and_loaded(finished)
        return [self._errors(energy, exact_rest, exact_loaded) for energy in self.stop_energies]

    def _errors(self, stop_energy: float, exact_rest: State, exact_loaded: State) -> dict[str, float]:
        bare = self.scene.updated({"protocol.stop_kinetic_energy": stop_energy, "protocol.static_finish": False})
        rest, loaded, disks = rest_and_loaded(bare)
        force, exact = floor_force(rest, disks), floor_force(exact_rest, disks)
        under, exactly = floor_force(loaded, disks), floor_force(exact_loaded, disks)
        response, true = under - force, exactly - exact
        total = float(np.abs(true.sum()))
        return {
            "rest_error": float(np.abs(force - exact).max() / exact.max()),
            "loaded_error": float(np.abs(under - exactly).max() / exactly.max()),
            "response_error": float(np.abs(response - true).max() / np.abs(true).max()),
            "sum_error": float(abs(response.sum() - true.sum()) / total),
        }


@dataclass(frozen=True)
class RestartTask:
    """A statically finished frictionless state, put back into the dynamics."""

    scene: Scene
    force: float
    steps: int

    def run(self) -> FloatArray:
        """Kinetic energy per disk at every reading."""
        problem = Problem.from_scene(self.scene)
        state = rest_state(problem)
        problem = problem.with_loads(state.position)
        if self.force:
            state = loaded_states(problem, state, [self.force])[1][0]
        still = replace(
            state, velocity=np.zeros_like(state.velocity), angular_velocity=np.zeros_like(state.angular_velocity)
        )
        return np.array(_read(problem, still, self.force, self.steps, READ_EVERY, Dynamics.kinetic_energy))


@dataclass(frozen=True)
class ResponseTask:
    """The response to one load by the paper's protocol, and what its stop criteria read."""

    scene: Scene

    def run(self) -> tuple[FloatArray, dict[str, float]]:
        rest, loaded, disks = rest_and_loaded(self.scene)
        response = (floor_force(loaded, disks) - floor_force(rest, disks)) / abs(loaded.load_factor)
        names = ("network_fixed_steps", "sliding_contacts", "mean_acceleration", "loose_disks", "kinetic_energy")
        return response, {name: float(getattr(loaded.reached, name)) for name in names}


@dataclass(frozen=True)
class SwingTask:
    """The run of a ResponseTask, going on after its stop."""

    scene: Scene
    steps: int
    read_every: int

    def run(self) -> tuple[FloatArray, FloatArray]:
        """Mean acceleration of disks with two contacts or more, and kinetic energy per disk, at every reading."""
        problem, _, loaded = _by_dynamics(self.scene)
        both = _read(
            problem, loaded, 1.0, self.steps, self.read_every, lambda d: (d.mean_acceleration(), d.kinetic_energy())
        )
        acceleration, energy = np.array(both).T
        return acceleration, energy


@dataclass(frozen=True)
class DisorderTask:
    """The smoothed response of one disordered slab, stopped early and finished statically."""

    scene: Scene
    stop_energy: float
    x: tuple[float, ...]
    width: float

    def run(self) -> FloatArray:
        """(2, x): stopped early, in equilibrium."""
        early = {"protocol.stop_kinetic_energy": self.stop_energy, "protocol.static_finish": False}
        return np.stack([self._response(self.scene.updated(early)), self._response(self.scene)])

    def _response(self, scene: Scene) -> FloatArray:
        problem, rest, loaded = _by_dynamics(scene)
        disks = floor_disks([rest, loaded], np.flatnonzero(problem.packing.row == 0))
        x = rest.position[disks, 0] - rest.position[problem.load_disk[0], 0]
        response = floor_response(rest, loaded, disks, float(np.abs(problem.load[:, 1]).sum()))
        return smoothed_response(self.x, x, response, self.width)


@dataclass(frozen=True)
class DampingTask:
    """Relaxation under gravity with one damping ratio."""

    scene: Scene
    time_step: float

    def run(self) -> tuple[float, float, float]:
        """Time to rest, whether it came to rest, and the largest step that Beeman's method would allow."""
        problem = Problem.from_scene(self.scene)
        protocol = self.scene.protocol
        dynamics = Dynamics(problem, problem.bare_state(), protocol.integrator, self.time_step)
        stop = Stop(protocol.stop_kinetic_energy, "envelope", protocol.maximum_steps)
        state = relax(dynamics, stop)
        return dynamics.time, float(bool(state.reached.settled)), stability_limit(problem, "beeman")


def rest_and_loaded(scene: Scene) -> tuple[State, State, NDArray[np.intp]]:
    """The packing at rest and under the scene's load, both by dynamics, and the disks of its lowest row.

    The ``load_factor`` of the loaded state is the total force, so that responses are per applied force.
    """
    problem, rest, loaded = _by_dynamics(scene)
    force = float(np.abs(problem.load[:, 1]).sum())
    return rest, replace(loaded, load_factor=force), np.flatnonzero(problem.packing.row == 0)


def _read(
    problem: Problem, state: State, load: float, steps: int, every: int, read: Callable[[Dynamics], Any]
) -> list[Any]:
    """What is read of the dynamics that goes on from ``state`` under a constant load, at ``every`` so many steps."""
    dynamics = Dynamics(problem, state, problem.scene.protocol.integrator, resolve_time_step(problem))
    dynamics.set_ramps(load=(load, load, 0.0))
    found = []
    for _ in range(steps // every):
        dynamics.advance(every)
        found.append(read(dynamics))
    return found


def _by_dynamics(scene: Scene) -> tuple[Problem, State, State]:
    """The problem with the scene's load, its state at rest and the loaded one."""
    problem = Problem.from_scene(scene.updated({"protocol.method": "dynamics"}))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    (loaded,) = loaded_states(problem, rest, [1.0])[1]
    return problem, rest, loaded


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``stop_energy``, ``restart``, ``at_rest``, ``swing``, ``time_step``, ``integrators``, ``damping`` and
    ``disorder``.
    """
    base, force, friction = parameters.scene, parameters.force, parameters.friction
    load = {"loads": [{"disk": "top-centre", "force": [0.0, -force]}]}
    loaded = base.updated(load)
    swing, disorder = parameters.swing, parameters.disorder
    half = disorder.spacing * np.arange(round(disorder.reach / disorder.spacing) + 1)
    grid = np.concatenate([-half[:0:-1], half])
    with_friction = loaded.updated({"contact.friction": friction})
    frictions, energies, ratios = parameters.frictions, parameters.stop_energies, parameters.damping.ratios
    restart, steps, integrators = parameters.restart, parameters.time_steps, parameters.integrators

    frictionless = base.updated({"contact.friction": 0.0, "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}]})
    tasks: dict[str, list[Task]] = {
        "damping": [
            DampingTask(
                base.updated(
                    {
                        "contact.friction": friction,
                        "contact.damping_ratio": ratio,
                        "protocol.integrator": "verlet",
                        "protocol.stop_kinetic_energy": parameters.damping.stop_kinetic_energy,
                    }
                ),
                parameters.damping.time_step,
            )
            for ratio in ratios
        ],
        "stop_energy": [StopTask(loaded.updated({"contact.friction": mu}), energies) for mu in frictions],
        "restart": [RestartTask(frictionless, f, restart.steps) for f in restart.forces],
        "swing": [
            SwingTask(
                with_friction.updated({"protocol.stop_rule": rule, "protocol.static_finish": False}),
                swing.steps,
                swing.read_every,
            )
            for rule in STOP_RULES
        ],
        "disorder": [
            DisorderTask(
                disorder.scene.updated({**load, "packing.realization": r}),
                disorder.stop_kinetic_energy,
                tuple(grid.tolist()),
                disorder.width,
            )
            for r in range(disorder.realizations)
        ],
        "time_step": [ResponseTask(with_friction.updated({"protocol.time_step": step})) for step in steps],
        "integrators": [
            ResponseTask(
                with_friction.updated(
                    {"protocol.integrator": name, "protocol.time_step": parameters.integrator_time_step}
                )
            )
            for name in integrators
        ],
    }
    every = [task for several in tasks.values() for task in several]
    results = iter(run_tasks(every, what="runs"))
    found = {name: [next(results) for _ in several] for name, several in tasks.items()}

    packing = base.packing.build()
    disks = np.flatnonzero(packing.row == 0)
    x = packing.position[disks, 0] - 0.5 * packing.width
    datasets = {
        "stop_energy": _stop_energy(frictions, energies, [one for several in found["stop_energy"] for one in several]),
        "restart": _restart(restart.forces, found["restart"]),
        "time_step": _responses("time_step", np.array(steps), "time step in sqrt(radius/g)", x, found["time_step"]),
        "integrators": _responses("integrator", np.array(integrators), "integrator", x, found["integrators"]),
        "damping": _damping(ratios, found["damping"]),
        "swing": _swing(swing.read_every, found["swing"]),
        "disorder": _disorder(grid, found["disorder"]),
    }
    datasets["at_rest"] = datasets["time_step"].drop_vars(["floor_response", "difference"]).isel(time_step=0)
    for dataset in datasets.values():
        dataset["force"] = variable((), force, f"applied force {FORCE}")
    return labelled(datasets, with_friction)


def _stop_energy(frictions: Sequence[float], energies: Sequence[float], found: list[dict[str, float]]) -> xr.Dataset:
    shape = (len(frictions), len(energies))
    texts = {
        "rest_error": "largest error of a floor force at rest, per largest floor force",
        "loaded_error": "largest error of a floor force under load, per largest floor force",
        "response_error": "largest error of the floor response, per largest response",
        "sum_error": "error of the sum of the floor response",
    }
    return xr.Dataset(
        {
            name: variable(("friction", "stop_kinetic_energy"), np.array([f[name] for f in found]).reshape(shape), text)
            for name, text in texts.items()
        },
        coords={
            "friction": variable("friction", frictions, "coefficient of friction between disks"),
            "stop_kinetic_energy": variable(
                "stop_kinetic_energy", energies, "kinetic energy per disk at which the dynamics stops"
            ),
        },
    )


def _restart(forces: Sequence[float], found: list[FloatArray]) -> xr.Dataset:
    return xr.Dataset(
        {
            "kinetic_energy": variable(
                ("load", "reading"), np.stack(found), "kinetic energy per disk after a restart of a finished state"
            ),
            "load": variable("load", forces, f"load of the restarted state {FORCE}"),
        },
        coords={
            "step": variable("reading", READ_EVERY * np.arange(1, found[0].size + 1), "time steps since the restart")
        },
    )


def _responses(
    dimension: str, values: NDArray, text: str, x: FloatArray, found: list[tuple[FloatArray, dict[str, float]]]
) -> xr.Dataset:
    response = np.stack([one for one, _ in found])
    largest = np.abs(response[0]).max()
    texts = {
        "network_fixed_steps": "time steps for which the contact network had not changed, at least",
        "sliding_contacts": "contacts at the Coulomb limit",
        "mean_acceleration": "mean acceleration of disks with two contacts or more, in g",
        "loose_disks": "disks with fewer than two contacts",
        "kinetic_energy": "kinetic energy per disk at the stop",
    }
    return xr.Dataset(
        {
            "floor_response": variable(
                (dimension, "floor_disk"), response, "vertical floor force that the load adds, per applied force"
            ),
            "difference": variable(
                dimension,
                np.abs(response - response[0]).max(axis=1) / largest,
                "largest difference of the floor response from that of the first entry, per largest response",
            ),
            **{name: variable(dimension, [i[name] for _, i in found], t) for name, t in texts.items()},
        },
        coords={
            dimension: variable(dimension, values, text),
            "x": variable("floor_disk", x, "position from the loaded disk in mean disk radii"),
        },
    )


def _swing(every: int, found: list[tuple[FloatArray, FloatArray]]) -> xr.Dataset:
    texts = {
        "mean_acceleration": "mean acceleration of disks with two contacts or more, in g",
        "kinetic_energy": "kinetic energy per disk",
    }
    return xr.Dataset(
        {
            name: variable(("stop_rule", "reading"), np.stack([one[k] for one in found]), text)
            for k, (name, text) in enumerate(texts.items())
        },
        coords={
            "stop_rule": variable("stop_rule", STOP_RULES, "rule by which the run had stopped"),
            "step": variable("reading", every * np.arange(1, found[0][0].size + 1), "time steps since the stop"),
        },
    )


def _disorder(x: FloatArray, found: list[FloatArray]) -> xr.Dataset:
    response = np.stack(found)
    return xr.Dataset(
        {
            name: variable(
                ("realization", "x"), response[:, k], f"smoothed floor response per applied force, {text}, in 1/radius"
            )
            for k, (name, text) in enumerate((("stopped", "of runs that stop early"), ("finished", "in equilibrium")))
        },
        coords={
            "realization": variable("realization", np.arange(len(found)), "realization of the radii"),
            "x": variable("x", x, "position from the loaded disk in mean disk radii"),
        },
    )


def _damping(ratios: Sequence[float], found: list[tuple[float, float, float]]) -> xr.Dataset:
    values = np.array(found)
    return xr.Dataset(
        {
            "relaxation_time": variable(
                "damping_ratio", values[:, 0], "time until the kinetic energy's envelope is at rest, in sqrt(radius/g)"
            ),
            "settled": variable("damping_ratio", values[:, 1].astype(np.int8), "1 if it came to rest"),
            "beeman_limit": variable(
                "damping_ratio", values[:, 2], "largest stable time step of Beeman's method in sqrt(radius/g)"
            ),
        },
        coords={
            "damping_ratio": variable("damping_ratio", ratios, "dashpot over its critical value, nu / (2 sqrt(k))")
        },
    )
