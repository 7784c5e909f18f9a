"""Where the work of a load goes along a quasi-static path: into stored energy, and into sliding.

Energies are in mean disk weights times mean radii. A sequence of equilibria has no inertia and no dashpots, so what a
load does and a packing does not store has slid away. Both sides are worked out from different things, which makes
their difference a check: the work from the load and the way of the loaded disks alone, the sliding from the contacts'
tangential forces and the part of their slip that their springs have not taken up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels import statics
from ..state import Contacts, FloatArray, State, wall_normals
from .equilibrium import reaction
from .problem import Problem


def stored(problem: Problem, state: State) -> float:
    """Energy of all springs, normal and tangential, and of the weights."""
    total = float(problem.weight @ state.position[:, 1])
    for contacts, law, shape, rolling in problem.kinds(state):
        total += statics.elastic_energy(contacts.overlap, shape, law)
        if law.friction > 0.0:
            total += 0.5 * law.tangential_stiffness * float(contacts.spring @ contacts.spring)
        if rolling is not None:
            total += 0.5 * rolling.stiffness * float(contacts.rolling_spring @ contacts.rolling_spring)
    return total


def work(problem: Problem, before: State, after: State) -> float:
    """Work of the loads from one state to the next: mean of their forces times the way of their disks.

    What displaced disks are held with counts as a force.
    Exact where ways are proportional to the change of the load; else the error is of third order in that change.
    """
    disk = problem.load_disk
    factor = 0.5 * (before.load_factor + after.load_factor)
    way = after.position[disk] - before.position[disk]
    turn = after.angle[disk] - before.angle[disk]
    total = factor * float(np.sum(problem.load[:, :2] * way) + problem.load[:, 2] @ turn)
    if len(problem.held):
        total += float(np.sum(0.5 * (reaction(problem, before) + reaction(problem, after)) * way))
    return total


@dataclass(frozen=True)
class Slid:
    """Energy that sliding, and rolling at its limit, took between two states.

    Contact by contact, in the order of the states' candidates.
    """

    pairs: FloatArray  #: (m,)
    walls: FloatArray  #: (w,)

    @property
    def total(self) -> float:
        return float(self.pairs.sum() + self.walls.sum())


def slid(problem: Problem, before: State, after: State) -> Slid:
    """Energy that sliding took between two neighbouring states of a path, with the same candidates.

    The slip of a contact that its spring has not taken up, times its mean tangential force. A contact that opens or
    closes in between slips for as long as it is closed, its overlap being taken as linear. The error is of second
    order in the distance of the states, where a contact begins or ceases to slide.
    """
    radius = problem.packing.radius
    turned = after.angle - before.angle
    moved = after.position - before.position
    old, new = before.pair_separation(), after.pair_separation()
    turn = np.arctan2(old[:, 0] * new[:, 1] - old[:, 1] * new[:, 0], np.sum(old * new, axis=1))
    distance = 0.5 * (np.hypot(*old.T) + np.hypot(*new.T))
    i, j, k = before.pairs.first, before.pairs.second, before.walls.first
    normal = wall_normals(before.walls.second)
    along = moved[k, 1] * normal[:, 0] - moved[k, 0] * normal[:, 1]
    pairs = _lost(before.pairs, after.pairs, distance * turn - radius[i] * turned[i] - radius[j] * turned[j])
    walls = _lost(before.walls, after.walls, along - radius[k] * turned[k])
    if problem.pair_rolling is not None:
        pairs += _lost(before.pairs, after.pairs, problem.pair_arms(i, j) * (turned[i] - turned[j]), "rolling_")
    if problem.wall_rolling is not None:
        walls += _lost(before.walls, after.walls, problem.wall_arms(k) * turned[k], "rolling_")
    return Slid(pairs, walls)


def _lost(before: Contacts, after: Contacts, slip: FloatArray, way: str = "") -> FloatArray:
    """(m,) mean tangential force times the part of ``slip`` (m,) that the springs have not taken up.

    ``way`` : "rolling_" for what is lost along the rolling.
    """
    closed = np.where(before.touching & after.touching, 1.0, 0.0)
    for one, other in ((before, after), (after, before)):
        half = one.touching & ~other.touching
        closed[half] = one.overlap[half] / (one.overlap[half] - other.overlap[half])
    force, spring = (f"{way}force" if way else "tangential_force"), f"{way}spring"
    mean = 0.5 * (getattr(before, force) + getattr(after, force))
    return -mean * (closed * slip - (getattr(after, spring) - getattr(before, spring)))
