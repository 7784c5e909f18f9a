"""Every small load at once: what a force on any disk adds to the force on the floor.

A stable state answers a force that is too small to change the status of any contact by ``dq = K^-1 f``, with the
tangent stiffness K, and the vertical force on a floor disk changes by ``c . dq``, with the row c of its floor contact.
So the influence of every disk on one floor disk is one solution with the transposed tangent, ``K^T y = c``: as many
solutions as there are floor disks, whatever the number of loads. What a load does to all contacts
(:func:`added_forces`) takes a solution of its own.
"""

from __future__ import annotations

import numpy as np

from ..contact.coulomb import limit
from ..errors import EquilibriumError
from ..state import AT_LIMIT, FLOOR, OPEN, FloatArray, State
from .problem import Problem
from .system import StaticSystem, Trial


def at_limit(problem: Problem, state: State) -> int:
    """How many closed contacts are at a limit of friction: what they answer depends on the direction of a load."""
    count = 0
    for contacts, laws, _ in problem.kinds(state):
        for law, force in zip(laws, contacts.forces, strict=False):
            most = (1.0 - AT_LIMIT) * limit(law, contacts.normal_force)
            count += int((contacts.touching & (np.abs(force) >= most) & (law.friction > 0.0)).sum())
    return count


def influence(problem: Problem, state: State, disks: np.ndarray, *, sliding: str = "refuse") -> FloatArray:
    """What a unit force or torque on any disk adds to the vertical floor force, in the limit of small loads.

    Parameters
    ----------
    problem : of the state; its loads do not matter, but a disk that they displace is held, and bears what is put on it.
    state : a stable state of static equilibrium.
    disks : (k,) the floor disks.
    sliding : "refuse" a state with contacts at the Coulomb limit, or let them "stick".

    Returns
    -------
    (k, n, freedoms) mean disk weights per mean disk weight along x and z, and per mean disk weight times mean radius
    for a torque where disks turn. NaN where nothing bears the load: for disks with less than two contacts, unless one
    transmits a couple, and along x where nothing holds the packing as a whole. 0 where a load holds the disk.

    Raises
    ------
    ValueError
        For another ``sliding``.
    EquilibriumError
        For a state that is not certified as stable, or that has contacts at the Coulomb limit where these are refused.
    """
    system, trial = sticking(problem, state, sliding)
    answer = system.answers(trial, transposed=True)
    n, freedoms = problem.n, problem.freedoms
    result = np.zeros((len(disks), n, freedoms))
    for row, disk in enumerate(disks):
        here = np.flatnonzero((system.wall_disk == disk) & (system.wall == FLOOR))
        force = np.zeros((freedoms, n))
        force[:, disk] = system.split(trial.tangent)[1][here, 1, :freedoms].sum(axis=0)
        result[row] = answer(force.ravel()).reshape(freedoms, n).T
    result[:, _loose(problem, state)] = np.nan
    return result


def _loose(problem: Problem, state: State) -> np.ndarray:
    """(n, freedoms) which unknowns nothing holds."""
    # one contact that transmits a couple holds a disk alone
    rows = zip(state.pairs.statuses != OPEN, state.walls.statuses != OPEN, strict=True)
    ties = np.sum([state.contact_count(between, walls=at_wall) for between, at_wall in rows], axis=0)
    loose = np.repeat(ties[:, None] < 2, problem.freedoms, axis=1)
    loose[:, 0] |= problem.slides_freely
    loose[problem.held.disk, problem.held.axis] = False
    return loose


def force_on(problem: Problem, disk: int, axis: int, size: float = 1.0) -> FloatArray:
    """(dof,) a force along x (``axis`` 0) or z (1) on a disk."""
    force = np.zeros((problem.freedoms, problem.n))
    force[axis, disk] = size
    return force.ravel()


def added_forces(system: StaticSystem, trial: Trial, moved: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What small displacements (dof,) add to the forces on ``pairs.first`` (m, 2) and on ``walls.first`` (w, 2)."""
    u = moved.reshape(-1, system.problem.n)
    i, j, k = system.first, system.second, system.wall_disk
    rim = system.problem.packing.radius * u[2] if len(u) > 2 else np.zeros(system.problem.n)
    pairs = np.stack([u[0, i] - u[0, j], u[1, i] - u[1, j], rim[i] + rim[j]])
    walls = np.stack([u[0, k], u[1, k], rim[k]])
    on_pairs, on_walls = (one[:, :2] for one in system.split(trial.tangent))
    return np.einsum("cab,bc->ca", on_pairs, pairs), np.einsum("cab,bc->ca", on_walls, walls)


def sticking(problem: Problem, state: State, sliding: str) -> tuple[StaticSystem, Trial]:
    """The equations at the state, every closed contact sticking; raises as :func:`influence`."""
    if sliding not in ("refuse", "stick"):
        raise ValueError(f"sliding = {sliding!r}: must be refuse or stick")
    if not (state.reached.certificate and state.reached.certificate.stable):
        raise EquilibriumError("the state is not certified as stable: small loads have no small answer")
    count = at_limit(problem, state)
    if count and sliding == "refuse":
        raise EquilibriumError(
            f"{count} contacts are at the Coulomb limit: the answer to a small load depends on its direction; "
            "sliding = 'stick' takes them as sticking"
        )
    system = StaticSystem(problem, state)
    known = system.start(state)
    never = np.full_like(system.limits(system.trial(known, known.q)), np.inf)
    return system, system.trial(known, known.q, limits=never)
