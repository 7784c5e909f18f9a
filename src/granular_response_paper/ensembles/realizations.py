"""One realization of a disordered slab: settled under gravity, then loaded through all forces of its case.

Without friction by minimisation, with friction along a path, unless ``method`` asks for the paper's protocol, dynamics
from rest to each force.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_response.errors import SolveError
from granular_response.observe import network
from granular_response.observe.floor import floor_disks, floor_force, wall_margin
from granular_response.scene import Scene
from granular_response.solvers.path import Collapsed
from granular_response.solvers.problem import Problem
from granular_response.solvers.timestep import stability_limit
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS, flags
from granular_response.studies import LoadPath, by_motion, lost
from granular_response_paper.ensembles import AT_REST, COLLAPSED, FAILED, NOT_REACHED, OUTCOMES
from granular_response_paper.ensembles.parameters import Case, EnsembleGroup
from granular_response_paper.parameters import material
from granular_response_paper.records import column, columns, record

#: Bins of the contact angles over half a turn.
ANGLE_BINS = 36


@record
class Packed:
    """What is counted on a packing at rest."""

    coordination_number: float = column("mean number of contacts between disks")
    coordination_number_bulk: float = column(
        "mean number of contacts of a disk 10 radii off the side walls, 4 off floor and top"
    )
    coordination_number_with_walls: float = column("mean number of contacts of a disk, walls included")
    horizontal_contacts: float = column("contacts of disks within 30 degrees of the horizontal, per number of disks")
    oblique_contacts: float = column("contacts of disks more than 30 degrees from the horizontal, per number of disks")
    loose_disks: float = column("disks with fewer than two contacts")
    force_residual: float = column(f"largest unbalanced force on a disk at rest {WEIGHTS}")
    torque_residual: float = column("largest unbalanced torque on a disk at rest, in mean weight times mean radius")
    coulomb_excess: float = column(f"largest excess of a tangential force over the Coulomb limit at rest {WEIGHTS}")
    negative_modes: float = column("unstable directions of the tangent stiffness at rest")
    settling_steps: float = column("time steps of the fall to rest")
    contact_angle_density: FloatArray = column(
        "distribution of the directions of contacts at rest, per radian", "angle"
    )

    @classmethod
    def of(cls, problem: Problem, rest: State) -> Packed:
        """A packing at ``rest``."""
        count = rest.position.shape[0]
        touching = rest.pairs.touching
        horizontal = np.abs(np.abs(rest.pair_normal()[touching, 0])) > np.cos(np.pi / 6.0)
        bulk = network.bulk_disks(rest, problem.packing.width, wall_margin(problem.packing.width))
        of_disks = partial(network.coordination_number, walls=False)
        return cls(
            coordination_number=of_disks(rest),
            coordination_number_bulk=of_disks(rest, bulk) if bulk.any() else float("nan"),
            coordination_number_with_walls=network.coordination_number(rest),
            horizontal_contacts=np.count_nonzero(horizontal) / count,
            oblique_contacts=np.count_nonzero(~horizontal) / count,
            settling_steps=float(rest.reached.steps or 0),
            contact_angle_density=network.contact_angle_histogram(rest, ANGLE_BINS)[1],
            **_certified(rest, cls),
        )

    @classmethod
    def unknown(cls) -> Packed:
        """A packing that does not come to rest."""
        numbers: dict[str, Any] = dict.fromkeys(columns(cls), float("nan"))
        return cls(**numbers | {"contact_angle_density": np.full(ANGLE_BINS, np.nan)})


@record
class Loaded:
    """What is measured under each force; nan after the end."""

    force_residual: FloatArray = column(f"largest unbalanced force on a disk under load {WEIGHTS}", "step")
    torque_residual: FloatArray = column(
        "largest unbalanced torque on a disk under load, in mean weight times mean radius", "step"
    )
    coulomb_excess: FloatArray = column(
        f"largest excess of a tangential force over the Coulomb limit under load {WEIGHTS}", "step"
    )
    negative_modes: FloatArray = column("unstable directions of the tangent stiffness under load", "step")
    lost: FloatArray = column("equilibria that the path has lost since the force before", "step")
    by_motion: FloatArray = column("1 where the motion of the disks led to the next one after some of them", "step")


@record
class Realization:
    """What is left of a task."""

    x: FloatArray = column(f"rest position of a floor disk from the loaded disk {RADII}", "slot")
    floor_response: FloatArray = column("vertical floor force that the load adds, per applied force", "step", "slot")
    outcome: NDArray[np.int8] = column("what became of the realization", "step", attributes=flags(OUTCOMES))
    message: str = column("why a realization failed")
    loaded: Loaded
    packing: Packed
    states: tuple[State, ...]  #: rest, then the kept ones


def _certified(state: State, kind: type) -> dict[str, Any]:
    """The entries of its certificate for which a record has a field; nan where one was not determined."""
    found = {name: getattr(state.certificate, name) for name in columns(kind) if hasattr(state.certificate, name)}
    return {name: np.nan if value is None else float(value) for name, value in found.items()}


def realize(
    scene: Scene, forces: tuple[float, ...], collapse_depth: float, *, keep: tuple[float, ...] = ()
) -> Realization:
    """Settle a packing and load it through all forces of its case. What fails is part of the result.

    ``scene`` has one load, of unit force; the states under the forces ``keep`` are handed back.
    """
    count = len(forces)
    outcome = np.full(count, NOT_REACHED, np.int8)
    loaded = {name: np.full(count, np.nan) for name in columns(Loaded)}
    message = ""
    try:
        path = LoadPath.of(scene)
    except SolveError as error:
        outcome[:1], message, none = FAILED, f"gravity: {error}", np.zeros(0)
        unknown = Loaded(**loaded), Packed.unknown()
        return Realization(none, np.zeros((count, 0)), outcome, message, *unknown, ())
    problem, rest = path.problem, path.rest
    disk = int(problem.load_disk[0])
    path.lowest = float(rest.position[disk, 1]) - collapse_depth
    states: list[State] = []
    for k, force in enumerate(forces):
        try:
            state = path.at(force)
        except Collapsed:
            outcome[k] = COLLAPSED
            break
        except SolveError as error:
            outcome[k], message = FAILED, f"force {force:g}: {error}"
            break
        values = {"lost": len(lost([state])), "by_motion": by_motion(state), **_certified(state, Loaded)}
        for name, value in values.items():
            loaded[name][k] = value
        if rest.position[disk, 1] - state.position[disk, 1] > collapse_depth:
            outcome[k] = COLLAPSED
            break
        outcome[k] = AT_REST
        states.append(state)
    disks = floor_disks([rest, *states], np.flatnonzero(problem.packing.row == 0))
    at_rest = floor_force(rest, disks)
    response = np.full((count, len(disks)), np.nan)
    for k, one in enumerate(states):
        response[k] = (floor_force(one, disks) - at_rest) / forces[k]
    kept = (rest, *(states[k] for k in range(len(states)) if forces[k] in keep)) if keep else ()
    x = rest.position[disks, 0] - rest.position[disk, 0]
    known = Loaded(**loaded), Packed.of(problem, rest)
    return Realization(x, response, outcome, message, *known, kept)


def ensemble_task(parameters: EnsembleGroup, case: Case, realization: int) -> partial[Realization]:
    """The task of one realization of a case."""
    return partial(realize, ensemble_scene(parameters, case, realization), case.forces, parameters.collapse_depth)


def ensemble_scene(parameters: EnsembleGroup, case: Case, realization: int) -> Scene:
    """The scene of one realization of a case.

    The time step is ``time_step_part`` of the stability limit of its lightest disk, at most
    ``longest_time_step``: without friction the limit is far beyond what the collisions of the fall need.
    """
    slow = {"preparation.gravity": "slow", "preparation.ramp_time": case.gravity_ramp} if case.gravity_ramp else {}
    changes = material(case.polydispersity, realization, case.friction, case.wall_friction)
    scene = parameters.base.updated({**changes, **slow, "packing.lattice_constant": case.lattice_constant})
    limit = stability_limit(Problem.from_scene(scene), smallest=True)
    step = min(parameters.time_step_part * limit, parameters.longest_time_step)
    return scene.updated({"protocol.time_step": step})
