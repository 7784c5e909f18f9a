"""The response of an ordered slab with friction against the force (Secs. V.A, V.B, V.D and V.E).

Figs. 6 to 9 (linear range, profiles, contact changes), Fig. 12 (friction at one force), Fig. 16 (large
forces), and the forces at which things happen. One load path per coefficient of friction serves every force
and tells its events. At large forces with much friction symmetric equilibria lose their stability, and which
one is reached depends on the transient: there the paper's protocol is followed, dynamics from rest to each
force; its ramp time is not told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from granular_response.observe import events
from granular_response.scene import Scene
from granular_response.solve import Problem
from granular_response.state import Event, State
from granular_response.store.result import FORCE, variable
from granular_response.sweeps.tasks import run_tasks
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.friction_linear_range.parameters import LargeForces, Parameters


@dataclass(frozen=True)
class PathResult:
    """What a load path leaves behind."""

    friction: float
    forces: tuple[float, ...]
    measured: xr.Dataset
    events: tuple[slab.Event, ...]
    lost: tuple[Event, ...]  #: equilibria
    method: str
    rest: State
    states: tuple[State, ...]  #: at ``forces``, or none


@dataclass(frozen=True)
class PathTask:
    """A load path through ``forces``, with its events."""

    scene: Scene
    forces: tuple[float, ...]
    asymmetry: float | None = None  #: from which symmetry is lost; none: no events
    keep_states: bool = False  #: and locate every event

    def run(self) -> PathResult:
        path = slab.LoadPath.of(self.scene)
        states = path.through(self.forces)
        measures = slab.Measures(path)
        return PathResult(
            self.scene.contact.friction,
            self.forces,
            slab.measured(measures, states),
            tuple(self._events(path, measures, self.asymmetry)) if self.asymmetry else (),
            tuple(slab.lost(states)),
            path.method,
            path.rest,
            tuple(states) if self.keep_states else (),
        )

    def _events(self, path: slab.LoadPath, measures: slab.Measures, asymmetry: float) -> list[slab.Event]:
        asked = slab.happenings(measures, path.known[self.forces[0]], asymmetry)
        return [
            slab.locate(name, path, self.forces, what)
            for name, what in asked.items()
            if self.keep_states or name in ("first_opening", "linear_range")
        ]


@dataclass(frozen=True)
class DynamicsTask:
    """One force applied to the packing at rest by dynamics."""

    scene: Scene
    rest: State
    force: float

    def run(self) -> tuple[State, xr.Dataset]:
        path = slab.LoadPath.of(self.scene, self.rest)
        state = path.at(self.force)
        return state, slab.measured(slab.Measures(path), [state])


@dataclass(frozen=True)
class FrictionTask:
    """The coefficient of friction, above ``low`` and not above ``high``, from which there is one peak."""

    scene: Scene
    force: float
    low: float
    high: float
    tolerance: float

    def run(self) -> slab.Event:
        def single_peaked(friction: float) -> bool:
            path = slab.LoadPath.of(self.scene.updated({"contact.friction": friction}))
            return not slab.Measures(path).double_peaked(path.at(self.force))

        found = events.bisect_event(single_peaked, self.low, self.high, self.tolerance, at_low=False, at_high=True)
        return _friction_crossover(self.force, found.low, found.high)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets of Figs. 6 to 9, 12 and 16.

    Returns
    -------
    ``response`` (friction, force), ``states_mu_<friction>`` (at rest first), ``friction_axis`` (friction),
    ``large_forces`` (force) with ``large_force_states``, ``events`` and ``lost``.
    """
    base, frictions, axis = parameters.base, parameters.frictions, parameters.friction_axis
    axis_frictions, axis_force = sorted(axis.frictions), axis.force
    tasks = _path_tasks(parameters, base, axis_frictions)
    results: list[PathResult] = run_tasks(tasks, what="load paths")
    paths = {result.friction: result for result in results}

    on_axis = {mu: _at_force(paths[mu], axis_force) for mu in axis_frictions}
    double = [bool(measured["double_peaked"][0]) for measured in on_axis.values()]
    low, high = slab.first_change(axis_frictions, [not two for two in double])
    refine = [FrictionTask(base, axis_force, low, high, axis.tolerance)]
    if not (double[0] and np.isfinite(high)):
        refine = []
    dynamics = _dynamics_tasks(parameters.dynamics, base, paths)
    done = run_tasks([*refine, *dynamics], what="large forces")
    crossover = done[0] if refine else _friction_crossover(axis_force, low, high)
    shaken: list[tuple[State, xr.Dataset]] = done[len(refine) :]

    main = [paths[mu] for mu in frictions]
    found = [*(event for result in main for event in result.events), crossover]
    datasets = {
        "response": _response_dataset(main),
        "friction_axis": slab.measured_along("friction", list(on_axis.values())).assign_coords(
            friction=_friction(axis_frictions)
        ),
        "lost": slab.lost_dataset([(result.friction, event) for result in main for event in result.lost]),
    }
    datasets["friction_axis"]["force"] = variable((), axis_force, f"applied force {FORCE}")
    for result in main:
        if result.states:
            datasets[f"states_mu_{result.friction:g}"] = _picture(base, [result.rest, *result.states])
    if dynamics:
        mu = parameters.dynamics.friction
        large = _large_forces_dataset(mu, dynamics, [measured for _, measured in shaken])
        datasets["large_forces"] = large
        datasets["large_force_states"] = _picture(base, [paths[mu].rest, *(state for state, _ in shaken)])
        found.append(_loss_of_symmetry(mu, large, parameters.asymmetry))
    datasets["events"] = slab.events_dataset(found)
    return labelled(datasets, base)


def _path_tasks(parameters: Parameters, base: Scene, axis_frictions: Sequence[float]) -> list[PathTask]:
    frictions, axis_force = parameters.frictions, parameters.friction_axis.force
    further = {extra.friction: extra.forces for extra in parameters.extra_forces}
    largest = {end.friction: end.force for end in parameters.ends}

    def task(mu: float) -> PathTask:
        scene = base.updated({"contact.friction": mu})
        if mu not in frictions:
            return PathTask(scene, (axis_force,))
        forces = {axis_force, *parameters.forces, *further.get(mu, ())}
        reached = tuple(sorted(force for force in forces if force <= largest.get(mu, np.inf)))
        keep = mu in parameters.states_of
        return PathTask(scene, reached, parameters.asymmetry, keep)

    return [task(mu) for mu in [*frictions, *(mu for mu in axis_frictions if mu not in frictions)]]


def _dynamics_tasks(given: LargeForces, base: Scene, paths: Mapping[float, PathResult]) -> list[DynamicsTask]:
    if not given.forces:
        return []
    scene = base.updated(
        {
            "contact.friction": given.friction,
            "protocol.method": "dynamics",
            "protocol.ramp_time": given.ramp_time,
            "protocol.time_step": given.time_step,
        }
    )
    return [DynamicsTask(scene, paths[given.friction].rest, force) for force in sorted(given.forces)]


def _at_force(result: PathResult, force: float) -> xr.Dataset:
    return result.measured.isel(state=[result.forces.index(force)])


def _friction_crossover(force: float, low: float, high: float) -> slab.Event:
    text = f"along the axis of friction at force {force:g}, the floor response no longer has two peaks"
    return slab.Event("friction_crossover", float("nan"), low, high, text)


def _loss_of_symmetry(friction: float, large: xr.Dataset, above: float) -> slab.Event:
    forces = large["force"].values
    low, high = slab.first_change(forces, (large["asymmetry"].values > above).tolist())
    text = f"dynamics from rest to each force: the asymmetry of the floor response exceeds {above:g}"
    return slab.Event("loss_of_symmetry", friction, low, high, text)


def _response_dataset(results: Sequence[PathResult]) -> xr.Dataset:
    """Friction by force; nan where a friction has no state at a force."""
    forces = sorted({force for result in results for force in result.forces})
    parts = [
        ((row, [forces.index(force) for force in result.forces]), result.measured) for row, result in enumerate(results)
    ]
    dims, shape = ("friction", "force"), (len(results), len(forces))
    dataset = slab.measured_dataset(dims, parts, shape).assign_coords(
        friction=_friction([result.friction for result in results]), force=_force(forces)
    )
    dataset.attrs["method"] = ", ".join(f"friction {r.friction:g}: {r.method}" for r in results)
    return dataset


def _large_forces_dataset(friction: float, tasks: Sequence[DynamicsTask], measured: Sequence[xr.Dataset]) -> xr.Dataset:
    dataset = slab.measured_along("force", measured).assign_coords(force=_force([task.force for task in tasks]))
    protocol = tasks[0].scene.protocol
    dataset["friction"] = variable((), friction, "coefficient of friction between disks")
    dataset["ramp_time"] = variable((), protocol.ramp_time, "duration of the load ramp in sqrt(radius/g)")
    dataset["time_step"] = variable((), protocol.time_step, "time step in sqrt(radius/g)")
    return dataset


def _picture(scene: Scene, states: Sequence[State]) -> xr.Dataset:
    return slab.states_picture(states, Problem.from_scene(scene).with_loads(states[0].position))


def _friction(values: Sequence[float]) -> xr.Variable:
    return variable("friction", values, "coefficient of friction between disks")


def _force(values: Sequence[float]) -> xr.Variable:
    return variable("force", values, f"applied force {FORCE}")
