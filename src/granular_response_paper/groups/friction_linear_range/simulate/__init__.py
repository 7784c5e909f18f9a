"""The response of an ordered slab with friction against the force (Secs. V.A, V.B, V.D and V.E).

Figs. 6 to 9 (linear range, profiles, contact changes), Fig. 12 (friction at one force), Fig. 16 (large forces), and the
forces at which things happen. One load path per coefficient of friction serves every force and tells its events. At
large forces with much friction symmetric equilibria lose their stability, and which one is reached depends on the
transient: there the paper's protocol is followed, dynamics from rest to each force; its ramp time is not told.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.scene import Scene
from granular_response.state import State
from granular_response.store.variables import WEIGHTS, variable
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.friction_linear_range.parameters import EqualRowsPaths, Parameters
from granular_response_paper.records import axes, table, variables
from granular_response_paper.tasks import computed

FRICTION, APPLIED = "coefficient of friction between disks", f"applied force {WEIGHTS}"


@dataclass(frozen=True)
class PathResult:
    """What a load path leaves behind."""

    forces: tuple[float, ...]
    measured: xr.Dataset
    events: list[slab.Event]
    method: str
    rest: State
    picture: xr.Dataset | None  #: of the states at rest and at ``forces``, where these are kept


def follow(scene: Scene, forces: tuple[float, ...], asymmetry: float | None = None, keep: bool = False) -> PathResult:
    """A load path through ``forces``.

    ``asymmetry`` is that from which symmetry is lost; without it no events are looked for. All of them are located, and
    states kept, where ``keep`` asks for it.
    """
    path = studies.LoadPath.of(scene)
    states, measures = path.through(forces), studies.Measures(path)
    asked = studies.happenings(measures, states[0], asymmetry) if asymmetry else {}
    asked = {name: what for name, what in asked.items() if keep or name in ("first_opening", "linear_range")}
    if asked and keep:
        asked["first_opening_anywhere"] = studies.first_opening(measures, anywhere=True)
    return PathResult(
        forces,
        slab.measured(measures, states),
        slab.locate(path, forces, asked),
        path.method,
        path.rest,
        slab.states_picture([path.rest, *states], path.problem) if keep else None,
    )


def equal_rows(scene: Scene, given: EqualRowsPaths) -> list[slab.Event]:
    """Events on the path of a slab with as many disks in every row; its load is half a radius off the middle."""
    path = studies.LoadPath.of(scene, packing=slab.equal_rows(given.layers, given.disks))
    path.through(given.forces)
    measures = studies.Measures(path)
    asked = {
        "first_opening": studies.first_opening(measures),
        "first_opening_anywhere": studies.first_opening(measures, anywhere=True),
        "crossover": studies.two_peaks(measures),
        "reaches_floor": studies.reaches_floor(measures),
    }
    return slab.locate(path, given.forces, asked)


def shake(scene: Scene, rest: State, force: float) -> tuple[State, xr.Dataset]:
    """One force applied to the packing at rest by dynamics."""
    path = studies.LoadPath.of(scene, rest)
    state = path.at(force)
    return state, slab.measured(studies.Measures(path), [state])


def narrow(scene: Scene, force: float, low: float, high: float, tolerance: float) -> tuple[float, float]:
    """The coefficient of friction, above ``low`` and not above ``high``, from which there is one peak."""

    def single_peaked(friction: float) -> bool:
        path = studies.LoadPath.of(scene.updated({"contact.friction": friction}))
        return not studies.Measures(path).double_peaked(path.at(force))

    return studies.bisect_event(single_peaked, low, high, tolerance, at_low=False, at_high=True).ends


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response`` (friction, force), ``states_mu_<friction>`` (at rest first), ``friction_axis`` (friction),
    ``large_forces`` (force) with ``large_force_states``, ``events`` and ``events_equal_rows``.
    """
    base, axis, given = parameters.base, parameters.friction_axis, parameters.dynamics
    paths = computed(_paths(parameters), "load paths")
    main = {mu: paths[mu] for mu in parameters.frictions}
    axis_frictions = sorted(axis.frictions)
    on_axis = [paths[mu].measured.isel(state=[paths[mu].forces.index(axis.force)]) for mu in axis_frictions]
    one_peak = [not measured["double_peaked"][0] for measured in on_axis]
    low, high = studies.first_change(axis_frictions, one_peak)
    protocol = {"method": "dynamics", "ramp_time": given.ramp_time, "time_step": given.time_step}
    shaken = base.updated({"contact.friction": given.friction, "protocol": protocol})
    tasks: dict[Any, partial[Any]]
    tasks = {force: partial(shake, shaken, main[given.friction].rest, force) for force in given.forces}
    if np.isfinite(high) and not one_peak[0]:
        tasks["crossover"] = partial(narrow, base, axis.force, low, high, axis.tolerance)
    same = parameters.equal_rows
    scenes = {mu: base.updated({"contact.friction": mu}) for mu in same.frictions}
    tasks |= {("equal rows", mu): partial(equal_rows, scene, same) for mu, scene in scenes.items()}
    done = computed(tasks, "large forces and equal rows")
    low, high = done.pop("crossover", (low, high))
    literal = [event for mu in same.frictions for event in done.pop(("equal rows", mu))]

    text = f"along the axis of friction at force {axis.force:g}, the floor response no longer has two peaks"
    found = [event for result in main.values() for event in result.events]
    found.append(slab.Event("friction_crossover", float("nan"), low, high, text))
    forces = sorted({force for one in main.values() for force in one.forces})
    parts = [((k, np.searchsorted(forces, one.forces)), one.measured) for k, one in enumerate(main.values())]
    response = slab.measured_dataset(("friction", "force"), parts, (len(main), len(forces)))
    response.attrs["method"] = ", ".join(f"friction {mu:g}: {one.method}" for mu, one in main.items())
    datasets = {
        "response": response.assign_coords(axes(friction=(main, FRICTION), force=(forces, APPLIED))),
        "friction_axis": slab.measured_along("friction", on_axis)
        .assign_coords(axes(friction=(axis_frictions, FRICTION)))
        .assign(force=variable((), axis.force, APPLIED)),
    }
    datasets |= {f"states_mu_{mu:g}": one.picture for mu, one in main.items() if one.picture is not None}
    states, measured = zip(*done.values(), strict=True)
    large = slab.measured_along("force", measured).assign_coords(axes(force=(done, APPLIED)))
    datasets["large_forces"] = large.assign(
        variables(
            friction=("", given.friction, FRICTION),
            ramp_time=("", given.ramp_time, "duration of the load ramp in sqrt(radius/g)"),
            time_step=("", given.time_step, "time step in sqrt(radius/g)"),
        )
    )
    rest = main[given.friction].rest
    datasets["large_force_states"] = slab.states_picture([rest, *states], studies.LoadPath.of(shaken, rest).problem)
    ends = studies.first_change(large["force"].values, large["asymmetry"].values > parameters.asymmetry)
    text = f"dynamics from rest to each force: the asymmetry of the floor response exceeds {parameters.asymmetry:g}"
    found.append(slab.Event("loss_of_symmetry", given.friction, *ends, text))
    datasets["events"] = table(found, "event")
    datasets["events_equal_rows"] = table(literal, "event")
    return labelled(datasets, base)


def _paths(parameters: Parameters) -> dict[float, partial[PathResult]]:
    """By friction: through all forces, and through that of the axis of friction alone for those of the axis alone."""
    base, axis, tasks = parameters.base, parameters.friction_axis, {}
    further = {extra.friction: extra.forces for extra in parameters.extra_forces}
    largest = {end.friction: end.force for end in parameters.ends}
    for mu in parameters.frictions:
        forces = sorted({axis.force, *parameters.forces, *further.get(mu, ())})
        reached = tuple(force for force in forces if force <= largest.get(mu, np.inf))
        path = partial(follow, base.updated({"contact.friction": mu}), reached)
        tasks[mu] = partial(path, parameters.asymmetry, mu in parameters.states_of)
    alone = [mu for mu in sorted(axis.frictions) if mu not in tasks]
    return tasks | {mu: partial(follow, base.updated({"contact.friction": mu}), (axis.force,)) for mu in alone}
