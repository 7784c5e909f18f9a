"""Slabs under a growing force (Secs. IV and V).

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
from granular_response_paper.tasks import computed


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """``slab_K`` for each friction."""
    scenes = [parameters.base.updated({"contact.friction": friction}) for friction in parameters.frictions]
    tasks = {f"slab_{k}": partial(states, scene, parameters.forces) for k, scene in enumerate(scenes)}
    return labelled(computed(tasks, "slabs"))


def states(scene: Scene, forces: tuple[float, ...]) -> xr.Dataset:
    """The states of a slab at rest and under ``forces``, with the ``elastic_response``.

    ``scene`` has one load, of unit force. Raises what ``solve_scene`` and ``influence`` raise.
    """
    solution = solve_scene(scene, load_factors=forces)
    kept, disk = pictured(solution), int(solution.problem.load_disk[0])
    found = influence(solution.problem, solution.rest, kept["floor_disk"].values, sliding="stick")[:, disk, 1]
    text = "floor response to a small load, all contacts sticking, per applied force"
    return kept.assign(elastic_response=variable("floor_disk", -found, text))
