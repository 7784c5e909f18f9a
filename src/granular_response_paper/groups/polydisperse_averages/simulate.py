"""Ensembles of polydisperse slabs under a growing force: Figs. 2, 19, 20 and 21 (Sec. VI), claims D1 to D5 and D7.

A *case* is a polydispersity, a coefficient of friction (of the walls too), a lattice constant of the start and a list
of growing forces; it has several realizations of the radii. One task settles one realization under gravity and
then loads it through all forces of its case (``realizations``), so a packing is settled once.

What becomes of a realization at each force is stored: ``at_rest``; ``collapsed``, where the load has pushed its
disk down by more than ``collapse_depth``, so that the packing is not the one that was prepared; ``failed``, where no
rest was found; ``not_reached`` after either. Averages are over those at rest, with their number beside them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from granular_response.scene import SceneError
from granular_response.solvers.problem import Problem
from granular_response.store.result import FORCE, LENGTH, common_candidates, states_dataset, variable
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import averages, datasets, realizations
from granular_response_paper.groups.polydisperse_averages.parameters import Case, Parameters


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles``, ``averages``, ``individual``, ``packings``, ``linear_range`` and ``forces``."""
    cases, picture, linear = parameters.columns, parameters.forces_picture, parameters.linear_range
    tasks: list[realizations.Task] = []
    shown = -1
    for case in cases:
        for realization in range(case.realizations):
            task = realizations.ensemble_task(parameters, case, realization)
            asked = (picture.polydispersity, picture.friction, picture.realization)
            this = (case.polydispersity, case.friction, realization)
            if shown < 0 and this == asked and picture.force in case.forces:
                shown = len(tasks)
                task = replace(task, keep=(picture.force,))
            tasks.append(task)
    grid = [(delta, mu) for delta in linear.polydispersities for mu in linear.frictions]
    for delta, mu in grid:
        case = Case(delta, mu, parameters.lattice_constant, linear.forces, 1, wall_friction=0.0)
        tasks.append(realizations.ensemble_task(parameters, case, 0))

    found = map_tasks(realizations.realize, tasks, what="realizations")
    ensemble, single = found[: len(found) - len(grid)], found[len(found) - len(grid) :]
    ensembles = datasets.ensembles_dataset(cases, ensemble)
    half = round(parameters.reach / parameters.spacing)
    x = np.arange(-half, half + 1, dtype=float) * parameters.spacing
    made = {
        "ensembles": ensembles,
        "averages": averages.averages_dataset(ensembles, x, widths=parameters.widths, few=parameters.few),
        "individual": averages.individual_dataset(ensembles, parameters.individual, x),
        "packings": datasets.packings_dataset(cases, ensemble),
        "linear_range": averages.linear_range_dataset(grid, linear.forces, single, linear.width, linear.tolerance),
        "forces": _forces_dataset(tasks[shown], found[shown], picture.polydispersity),
    }
    return labelled(made, tasks[0].scene)


def _forces_dataset(task: realizations.Task, found: realizations.Realization, polydispersity: float) -> xr.Dataset:
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
        force=variable("state", [state.load_factor for state in states], f"applied force {FORCE}"),
        radius=variable("disk", packing.radius, f"disk radius {LENGTH}"),
        width=variable((), packing.width, f"distance of the side walls {LENGTH}"),
        loaded_disk=variable((), int(problem.load_disk[0]), "index of the loaded disk"),
        polydispersity=variable((), polydispersity, "delta: spread of the radii"),
        friction=variable((), task.scene.contact.friction, "coefficient of friction, walls included"),
    )
