"""Ensembles of polydisperse slabs under a growing force: Figs. 2, 19, 20 and 21 (Sec. VI), claims D1 to D5 and D7.

A *case* is a polydispersity, a coefficient of friction (of the walls too), a lattice constant of the start and a list
of growing forces; it has several realizations of the radii. One task settles one realization under gravity and
then loads it through all forces of its case (``realizations``), so a packing is settled once.

What becomes of a realization at each force is stored: ``at_rest``; ``collapsed``, where the load has pushed its
disk down by more than ``collapse_depth``, so that the packing is not the one that was prepared; ``failed``, where no
rest was found; ``not_reached`` after either. Averages are over those at rest, with their number beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from granular_response.paper.datasets import labelled
from granular_response.paper.ensembles import NOT_REACHED, OUTCOMES
from granular_response.paper.groups.polydisperse_averages.ensemble.averages import (
    averages_dataset,
    individual_dataset,
    linear_range_dataset,
)
from granular_response.paper.groups.polydisperse_averages.ensemble.realizations import (
    ANGLE_BINS,
    LOADED,
    PACKING,
    Realization,
    Task,
    ensemble_scene,
    realize,
)
from granular_response.paper.groups.polydisperse_averages.parameters import Case, Parameters
from granular_response.scene import SceneError
from granular_response.solve import Problem
from granular_response.store.result import FORCE, LENGTH, common_candidates, states_dataset, variable
from granular_response.sweeps.tasks import Progress, map_tasks


def simulate(
    parameters: Parameters, *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles``, ``averages``, ``individual``, ``packings``, ``linear_range`` and ``forces``."""
    cases, picture, linear = parameters.columns, parameters.forces_picture, parameters.linear_range
    loading = parameters.loading
    usual = (parameters.collapse_depth, loading.ramp_time, loading.largest_rate, loading.stop_kinetic_energy)
    tasks: list[Task] = []
    shown = -1
    for case in cases:
        for realization in range(case.realizations):
            task = Task(ensemble_scene(parameters, case, realization), case.forces, *usual)
            asked = (picture.polydispersity, picture.friction, picture.realization)
            this = (case.polydispersity, case.friction, realization)
            if shown < 0 and this == asked and picture.force in case.forces:
                shown = len(tasks)
                task = replace(task, keep=(picture.force,))
            tasks.append(task)
    grid = [(delta, mu) for delta in linear.polydispersities for mu in linear.frictions]
    for delta, mu in grid:
        case = Case(delta, mu, parameters.lattice_constant, linear.forces, 1)
        task = Task(ensemble_scene(parameters, case, 0, wall_friction=0.0), linear.forces, *usual)
        tasks.append(replace(task, ramp_time=linear.ramp_time))

    found = map_tasks(realize, tasks, workers=workers, progress=progress, what="realizations")
    ensemble, single = found[: len(found) - len(grid)], found[len(found) - len(grid) :]
    ensembles = _ensembles_dataset(cases, ensemble)
    half = round(parameters.reach / parameters.spacing)
    x = np.arange(-half, half + 1, dtype=float) * parameters.spacing
    datasets = {
        "ensembles": ensembles,
        "averages": averages_dataset(ensembles, x, widths=parameters.widths, few=parameters.few),
        "individual": individual_dataset(ensembles, parameters.individual, x),
        "packings": _packings_dataset(cases, ensemble),
        "linear_range": linear_range_dataset(grid, linear.forces, single, linear.width, linear.tolerance),
        "forces": _forces_dataset(tasks[shown], found[shown], picture.polydispersity),
    }
    return labelled(datasets, tasks[0].scene)


def _case_coordinates(cases: Sequence[Case]) -> dict[str, xr.Variable]:
    lattice = [str(case.lattice_constant) for case in cases]
    return {
        "polydispersity": variable(("case",), [c.polydispersity for c in cases], "delta: spread of the radii"),
        "friction": variable(("case",), [c.friction for c in cases], "coefficient of friction, walls included"),
        "lattice_constant": variable(
            ("case",), lattice, f"distance of neighbours before gravity acts {LENGTH}, or how it is chosen"
        ),
        "realizations": variable(("case",), [c.realizations for c in cases], "number of packings"),
    }


def _ensembles_dataset(cases: Sequence[Case], found: Sequence[Realization]) -> xr.Dataset:
    """Every realization of every case; what a case does not have is nan, or NOT_REACHED."""
    most = max(case.realizations for case in cases)
    steps = max(len(case.forces) for case in cases)
    slots = max(one.x.size for one in found)
    shape = (len(cases), most, steps)
    force = np.full((len(cases), steps), np.nan)
    x = np.full((len(cases), most, slots), np.nan)
    rest_force = np.full_like(x, np.nan)
    response = np.full((*shape, slots), np.nan)
    outcome = np.full(shape, NOT_REACHED, np.int8)
    loaded = {name: np.full(shape, np.nan) for name in LOADED}
    message = np.full((len(cases), most), "", dtype=object)
    left = iter(found)
    for c, case in enumerate(cases):
        k = len(case.forces)
        force[c, :k] = case.forces
        for r in range(case.realizations):
            one = next(left)
            x[c, r, : one.x.size], rest_force[c, r, : one.x.size] = one.x, one.rest_force
            response[c, r, :k, : one.x.size] = one.response
            outcome[c, r, :k] = one.outcome
            message[c, r] = one.message
            for name in LOADED:
                loaded[name][c, r, :k] = one.loaded[name]
    dims = ("case", "realization", "step")
    data = {
        "force": variable(("case", "step"), force, f"applied force {FORCE}"),
        "x": variable(
            ("case", "realization", "slot"), x, f"rest position of a floor disk from the loaded disk {LENGTH}"
        ),
        "floor_force_rest": variable(
            ("case", "realization", "slot"), rest_force, f"vertical floor force at rest {FORCE}"
        ),
        "floor_response": variable(
            (*dims, "slot"), response, "vertical floor force that the load adds, per applied force"
        ),
        "outcome": variable(
            dims,
            outcome,
            "what became of the realization",
            flag_values=np.arange(len(OUTCOMES), dtype=np.int8),
            flag_meanings=" ".join(OUTCOMES),
        ),
        "message": variable(("case", "realization"), message.astype(str), "why a realization failed"),
        **{name: variable(dims, loaded[name], text) for name, text in LOADED.items()},
    }
    return xr.Dataset(data, coords=_case_coordinates(cases))


def _packings_dataset(cases: Sequence[Case], found: Sequence[Realization]) -> xr.Dataset:
    shape = (len(cases), max(case.realizations for case in cases))
    numbers = {name: np.full(shape, np.nan) for name in PACKING}
    density = np.full((*shape, ANGLE_BINS), np.nan)
    left = iter(found)
    for c, case in enumerate(cases):
        for r in range(case.realizations):
            one = next(left)
            density[c, r] = one.angle_density
            for name in PACKING:
                numbers[name][c, r] = one.packing[name]
    dims = ("case", "realization")
    angle = np.pi / ANGLE_BINS * np.arange(ANGLE_BINS)
    return xr.Dataset(
        {
            **{name: variable(dims, numbers[name], text) for name, text in PACKING.items()},
            "contact_angle_density": variable(
                (*dims, "angle"), density, "distribution of the directions of contacts at rest, per radian"
            ),
        },
        coords={
            "angle": variable(("angle",), angle, "angle of a contact with the horizontal, in radians"),
            **_case_coordinates(cases),
        },
    )


def _forces_dataset(task: Task, found: Realization, polydispersity: float) -> xr.Dataset:
    """The states of Fig. 2: at rest, and under load."""
    problem = Problem.from_scene(task.scene)
    if len(found.states) != 2:
        raise SceneError(f"forces_picture: the realization does not reach its force ({found.message or 'collapsed'})")
    packing = problem.packing
    problem = problem.with_loads(found.states[0].position)
    states = common_candidates(found.states, packing.radius)
    dataset = states_dataset(states)
    dataset["axis"].attrs.update(long_name="axis labels", units="1")
    return dataset.assign(
        force=variable(("state",), np.array([state.load_factor for state in states]), f"applied force {FORCE}"),
        radius=variable(("disk",), packing.radius, f"disk radius {LENGTH}"),
        width=variable((), packing.width, f"distance of the side walls {LENGTH}"),
        loaded_disk=variable((), int(problem.load_disk[0]), "index of the loaded disk"),
        polydispersity=variable((), polydispersity, "delta: spread of the radii"),
        friction=variable((), task.scene.contact.friction, "coefficient of friction, walls included"),
    )
