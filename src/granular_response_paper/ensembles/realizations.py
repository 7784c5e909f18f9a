"""One realization of a disordered slab: settled under gravity, then loaded through all forces of its case.

Without friction by minimisation, with friction along a path, unless ``method`` asks for the paper's protocol, dynamics
from rest to each force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from granular_response.errors import SolveError
from granular_response.observe import network
from granular_response.observe.floor import floor_disks, floor_force
from granular_response.scene import Scene
from granular_response.solvers.path import Collapsed
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import stability_limit
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH
from granular_response_paper.ensembles import AT_REST, COLLAPSED, FAILED, NOT_REACHED
from granular_response_paper.groups.polydisperse_averages.parameters import Case, EnsembleGroup
from granular_response_paper.slab_response import LoadPath, by_motion, lost

#: Bins of the contact angles over half a turn.
ANGLE_BINS = 36

#: What is counted on a packing at rest, with long names.
PACKING = {
    "coordination_number": "mean number of contacts between disks",
    "coordination_number_bulk": "mean number of contacts of a disk 10 radii off the side walls, 4 off floor and top",
    "coordination_number_with_walls": "mean number of contacts of a disk, walls included",
    "coordination_number_bearing": "mean number of contacts between disks that bear load",
    "horizontal_contacts": "contacts of disks within 30 degrees of the horizontal, per number of disks",
    "oblique_contacts": "contacts of disks more than 30 degrees from the horizontal, per number of disks",
    "loose_disks": "disks with fewer than two contacts",
    "force_residual": f"largest unbalanced force on a disk at rest {FORCE}",
    "torque_residual": "largest unbalanced torque on a disk at rest, in mean weight times mean radius",
    "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit at rest {FORCE}",
    "negative_modes": "unstable directions of the tangent stiffness at rest",
    "largest_overlap": f"largest overlap of two disks at rest {LENGTH}",
    "settling_steps": "time steps of the fall to rest",
}

#: What is measured on a loaded state, with long names.
LOADED = {
    "sink": f"how far the load has pushed its disk down {LENGTH}",
    "largest_displacement": f"largest displacement of a disk since rest {LENGTH}",
    "force_residual": f"largest unbalanced force on a disk under load {FORCE}",
    "torque_residual": "largest unbalanced torque on a disk under load, in mean weight times mean radius",
    "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit under load {FORCE}",
    "negative_modes": "unstable directions of the tangent stiffness under load",
    "lost": "equilibria that the path has lost since the force before",
    "by_motion": "1 where the motion of the disks led to the next one after some of them",
}


@dataclass(frozen=True)
class Task:
    """One realization through all forces of its case."""

    scene: Scene  #: with one load, of unit force
    forces: tuple[float, ...]
    collapse_depth: float
    keep: tuple[float, ...] = ()  #: forces whose states are handed back


@dataclass(frozen=True)
class Realization:
    """What is left of a task; arrays along force are nan after its end."""

    x: FloatArray  #: (k,) rest position of the floor disks from the loaded disk
    rest_force: FloatArray  #: (k,) vertical floor force at rest
    response: FloatArray  #: (forces, k)
    outcome: NDArray[np.int8]  #: (forces,)
    loaded: Mapping[str, FloatArray]  #: LOADED, each (forces,)
    packing: Mapping[str, float]  #: PACKING
    angle_density: FloatArray  #: (bins,)
    message: str = ""  #: why it failed
    states: tuple[State, ...] = field(default=(), compare=False)  #: rest, then the kept ones


def realize(task: Task) -> Realization:
    """Settle a packing and load it. What fails is part of the result."""
    count = len(task.forces)
    outcome = np.full(count, NOT_REACHED, np.int8)
    loaded = {name: np.full(count, np.nan) for name in LOADED}
    message = ""
    try:
        path = LoadPath.of(task.scene)
    except SolveError as error:
        none = np.zeros(0)
        outcome[:1] = FAILED
        return Realization(
            x=none,
            rest_force=none,
            response=np.zeros((count, 0)),
            outcome=outcome,
            loaded=loaded,
            packing=dict.fromkeys(PACKING, np.nan),
            angle_density=np.full(ANGLE_BINS, np.nan),
            message=f"gravity: {error}",
        )
    problem, rest = path.problem, path.rest
    disk = int(problem.load_disk[0])
    path.lowest = float(rest.position[disk, 1]) - task.collapse_depth
    states: list[State] = []
    for k, force in enumerate(task.forces):
        try:
            state = path.at(force)
        except Collapsed as collapse:
            outcome[k], loaded["sink"][k] = COLLAPSED, rest.position[disk, 1] - collapse.height
            break
        except SolveError as error:
            outcome[k], message = FAILED, f"force {force:g}: {error}"
            break
        moved = state.position - rest.position
        certificate = state.certificate
        values = {
            "sink": -moved[disk, 1],
            "largest_displacement": np.hypot(moved[:, 0], moved[:, 1]).max(),
            "lost": len(lost([state])),
            "by_motion": by_motion(state),
            **{name: getattr(certificate, name) for name in LOADED if hasattr(certificate, name)},
        }
        for name in LOADED:
            loaded[name][k] = values[name]
        if values["sink"] > task.collapse_depth:
            outcome[k] = COLLAPSED
            break
        outcome[k] = AT_REST
        states.append(state)
    disks = floor_disks([rest, *states], np.flatnonzero(problem.packing.row == 0))
    at_rest = floor_force(rest, disks)
    response = np.full((count, len(disks)), np.nan)
    for k, one in enumerate(states):
        response[k] = (floor_force(one, disks) - at_rest) / task.forces[k]
    kept = tuple(states[k] for k in range(len(states)) if task.forces[k] in task.keep)
    return Realization(
        x=rest.position[disks, 0] - rest.position[disk, 0],
        rest_force=at_rest,
        response=response,
        outcome=outcome,
        loaded=loaded,
        packing=_packing_numbers(problem, rest),
        angle_density=network.contact_angle_histogram(rest, ANGLE_BINS)[1],
        message=message,
        states=(rest, *kept) if task.keep else (),
    )


def _packing_numbers(problem: Problem, rest: State) -> dict[str, float]:
    count = rest.position.shape[0]
    touching = rest.pairs.touching
    horizontal = np.abs(np.abs(rest.pair_normal()[touching, 0])) > np.cos(np.pi / 6.0)
    certificate = rest.certificate
    bulk = network.bulk_disks(rest, problem.packing.width, min(10.0, 0.2 * problem.packing.width))
    return {
        "coordination_number": network.coordination_number(rest),
        "coordination_number_bulk": network.coordination_number(rest, bulk) if bulk.any() else float("nan"),
        "coordination_number_with_walls": network.coordination_number(rest, walls=True),
        "coordination_number_bearing": network.coordination_number(rest, without_rattlers=True),
        "horizontal_contacts": np.count_nonzero(horizontal) / count,
        "oblique_contacts": np.count_nonzero(~horizontal) / count,
        "largest_overlap": float(rest.pairs.overlap.max()),
        "settling_steps": float(rest.reached.steps or 0),
        **{
            name: float(getattr(certificate, name))
            for name in ("loose_disks", "force_residual", "torque_residual", "coulomb_excess", "negative_modes")
        },
    }


def ensemble_task(parameters: EnsembleGroup, case: Case, realization: int) -> Task:
    """The task of one realization of a case."""
    return Task(ensemble_scene(parameters, case, realization), case.forces, parameters.collapse_depth)


def ensemble_scene(parameters: EnsembleGroup, case: Case, realization: int) -> Scene:
    """The scene of one realization of a case.

    The time step is ``time_step_part`` of the stability limit of its lightest disk, at most
    ``longest_time_step``: without friction the limit is far beyond what the collisions of the fall need.
    """
    scene = parameters.base.updated(
        {
            "packing.polydispersity": case.polydispersity,
            "packing.lattice_constant": case.lattice_constant,
            "packing.realization": realization,
            "contact.friction": case.friction,
            "wall.friction": case.friction if case.wall_friction is None else case.wall_friction,
        }
    )
    limit = stability_limit(Problem.from_scene(scene), smallest=True)
    step = min(parameters.time_step_part * limit, parameters.longest_time_step)
    return scene.updated({"protocol.time_step": step})
