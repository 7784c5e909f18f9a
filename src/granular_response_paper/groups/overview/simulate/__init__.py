"""Slabs under a growing force (Secs. IV and V), and packings as in the experiments with photoelastic disks (Sec. II.B).

Each dataset holds the states of one slab as ``granular_response.plot`` draws them: at rest first, then under each
force.
"""

from __future__ import annotations

from functools import partial

import xarray as xr

from granular_response.scene import Scene
from granular_response.solvers.small_loads import influence
from granular_response.solvers.solution import solve_scene
from granular_response.store.variables import variable
from granular_response_paper.datasets import labelled, pictured
from granular_response_paper.groups.overview.parameters import Parameters
from granular_response_paper.slab_response import disordered
from granular_response_paper.tasks import computed


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """``slab_K`` for each friction, ``photoelastic_K`` for each polydispersity."""
    base, experiment = parameters.base, parameters.experiment
    fall = disordered(experiment.stop_kinetic_energy)
    rough = {"contact.friction": experiment.friction, "wall.friction": experiment.friction}
    tasks = {
        f"slab_{k}": partial(states, base.updated({"contact.friction": friction}), parameters.forces, elastic=True)
        for k, friction in enumerate(parameters.frictions)
    }
    for k, delta in enumerate(experiment.polydispersities):
        scene = base.updated({**rough, "packing.polydispersity": delta, **(fall if delta else {})})
        tasks[f"photoelastic_{k}"] = partial(states, scene, (experiment.force,))
    return labelled(computed(tasks, "packings"))


def states(scene: Scene, forces: tuple[float, ...], *, elastic: bool = False) -> xr.Dataset:
    """The states of a slab at rest and under ``forces``; with the ``elastic_response`` if asked.

    ``scene`` has one load, of unit force. Raises what ``solve_scene`` and ``influence`` raise.
    """
    solution = solve_scene(scene, load_factors=forces)
    kept = pictured(solution)
    if not elastic:
        return kept
    disk = int(solution.problem.load_disk[0])
    found = influence(solution.problem, solution.rest, kept["floor_disk"].values, sliding="stick")[:, disk, 1]
    return kept.assign(
        elastic_response=variable(
            "floor_disk", -found, "floor response to a small load, all contacts sticking, per applied force"
        )
    )
