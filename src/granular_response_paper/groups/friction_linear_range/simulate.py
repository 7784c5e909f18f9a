"""The response of an ordered slab with friction against the force (Secs. V.A, V.B, V.D and V.E).

Figs. 6 to 9 (linear range, profiles, contact changes), Fig. 12 (friction at one force), Fig. 16 (large
forces), and the forces at which things happen. One load path per coefficient of friction serves every force
and tells its events. At large forces with much friction symmetric equilibria lose their stability, and which
one is reached depends on the transient: there the paper's protocol is followed, dynamics from rest to each
force; its ramp time is not told.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import events
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.state import State
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.friction_linear_range.parameters import Parameters
from granular_response_paper.records import axes, table, variables
from granular_response_paper.slab_response import LoadPath, Measures
from granular_response_paper.tasks import computed

FRICTION, APPLIED = "coefficient of friction between disks", f"applied force {WEIGHTS}"


@dataclass(frozen=True)
class PathResult:
    """What a load path leaves behind."""

    forces: tuple[float, ...]
    measured: xr.Dataset
    events: list[slab.Event]
    lost: list[slab.Lost]
    method: str
    states: list[State]  #: at rest, and at ``forces``, or these are not kept


def follow(scene: Scene, forces: tuple[float, ...], asymmetry: float | None = None, keep: bool = False) -> PathResult:
    """A load path through ``forces``.

    ``asymmetry`` is that from which symmetry is lost; without it no events are looked for. All of them are located, and
    states kept, where ``keep`` asks for it.
    """
    path = LoadPath.of(scene)
    states, measures = path.through(forces), Measures(path)
    asked = slab.happenings(measures, states[0], asymmetry) if asymmetry else {}
    if not keep:
        asked = {name: what for name, what in asked.items() if name in ("first_opening", "linear_range")}
    return PathResult(
        forces,
        slab.measured(measures, states),
        slab.locate(path, forces, asked),
        [slab.Lost.of(measures.friction, event) for event in slab.lost(states)],
        path.method,
        [path.rest, *states] if keep else [path.rest],
    )


def shake(scene: Scene, rest: State, force: float) -> tuple[State, xr.Dataset]:
    """One force applied to the packing at rest by dynamics."""
    path = LoadPath.of(scene, rest)
    state = path.at(force)
    return state, slab.measured(Measures(path), [state])


def narrow(scene: Scene, force: float, low: float, high: float, tolerance: float) -> tuple[float, float]:
    """The coefficient of friction, above ``low`` and not above ``high``, from which there is one peak."""

    def single_peaked(friction: float) -> bool:
        path = LoadPath.of(scene.updated({"contact.friction": friction}))
        return not Measures(path).double_peaked(path.at(force))

    found = events.bisect_event(single_peaked, low, high, tolerance, at_low=False, at_high=True)
    return found.low, found.high


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response`` (friction, force), ``states_mu_<friction>`` (at rest first), ``friction_axis`` (friction),
    ``large_forces`` (force) with ``large_force_states``, ``events`` and ``lost``.
    """
    base, axis, given = parameters.base, parameters.friction_axis, parameters.dynamics
    paths = computed(_paths(parameters), "load paths")

    axis_frictions = sorted(axis.frictions)
    on_axis = [paths[mu].measured.isel(state=[paths[mu].forces.index(axis.force)]) for mu in axis_frictions]
    one_peak = [not measured["double_peaked"][0] for measured in on_axis]
    low, high = slab.first_change(axis_frictions, one_peak)
    further: dict[float | str, Callable[[], Any]] = {}
    if np.isfinite(high) and not one_peak[0]:
        further["crossover"] = partial(narrow, base, axis.force, low, high, axis.tolerance)
    ramp = {f"protocol.{name}": getattr(given, name) for name in ("ramp_time", "time_step")}
    shaken = base.updated({"contact.friction": given.friction, "protocol.method": "dynamics", **ramp})
    for force in sorted(given.forces):
        further[force] = partial(shake, shaken, paths[given.friction].states[0], force)
    done = computed(further, "large forces")
    low, high = done.pop("crossover", (low, high))

    main = {mu: paths[mu] for mu in parameters.frictions}
    text = f"along the axis of friction at force {axis.force:g}, the floor response no longer has two peaks"
    found = [event for result in main.values() for event in result.events]
    found.append(slab.Event("friction_crossover", float("nan"), low, high, text))
    datasets = {
        "response": _response_dataset(main),
        "friction_axis": slab.measured_along("friction", on_axis)
        .assign_coords(axes(friction=(axis_frictions, FRICTION)))
        .assign(force=variable((), axis.force, APPLIED)),
        "lost": table([one for result in main.values() for one in result.lost], "lost", kind=slab.Lost),
    }
    for mu, result in main.items():
        if result.states[1:]:
            datasets[f"states_mu_{mu:g}"] = _picture(base, result.states)
    if done:
        states, measured = zip(*done.values(), strict=True)
        large = slab.measured_along("force", measured).assign_coords(axes(force=(done, APPLIED)))
        datasets["large_forces"] = large.assign(
            variables(
                friction=("", given.friction, FRICTION),
                ramp_time=("", given.ramp_time, "duration of the load ramp in sqrt(radius/g)"),
                time_step=("", given.time_step, "time step in sqrt(radius/g)"),
            )
        )
        datasets["large_force_states"] = _picture(base, [paths[given.friction].states[0], *states])
        ends = slab.first_change(large["force"].values, large["asymmetry"].values > parameters.asymmetry)
        text = f"dynamics from rest to each force: the asymmetry of the floor response exceeds {parameters.asymmetry:g}"
        found.append(slab.Event("loss_of_symmetry", given.friction, *ends, text))
    datasets["events"] = slab.events_dataset(found)
    return labelled(datasets, base)


def _paths(parameters: Parameters) -> dict[float, partial[PathResult]]:
    """By friction: through all forces, and through that of the axis of friction alone for those of the axis alone."""
    axis = parameters.friction_axis
    further = {extra.friction: extra.forces for extra in parameters.extra_forces}
    largest = {end.friction: end.force for end in parameters.ends}
    scenes = {
        mu: parameters.base.updated({"contact.friction": mu})
        for mu in dict.fromkeys([*parameters.frictions, *sorted(axis.frictions)])
    }
    paths = {mu: partial(follow, scene, (axis.force,)) for mu, scene in scenes.items()}
    for mu in parameters.frictions:
        forces = {axis.force, *parameters.forces, *further.get(mu, ())}
        reached = tuple(sorted(force for force in forces if force <= largest.get(mu, np.inf)))
        paths[mu] = partial(follow, scenes[mu], reached, parameters.asymmetry, mu in parameters.states_of)
    return paths


def _response_dataset(results: dict[float, PathResult]) -> xr.Dataset:
    """Friction by force; nan where a friction has no state at a force."""
    forces = sorted({force for result in results.values() for force in result.forces})
    parts = [
        ((row, [forces.index(force) for force in result.forces]), result.measured)
        for row, result in enumerate(results.values())
    ]
    dataset = slab.measured_dataset(("friction", "force"), parts, (len(results), len(forces)))
    dataset.attrs["method"] = ", ".join(f"friction {mu:g}: {result.method}" for mu, result in results.items())
    return dataset.assign_coords(axes(friction=(results, FRICTION), force=(forces, APPLIED)))


def _picture(scene: Scene, states: Sequence[State]) -> xr.Dataset:
    return slab.states_picture(states, Problem.from_scene(scene).with_loads(states[0].position))
