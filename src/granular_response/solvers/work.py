"""Where the work of a load goes along a quasi-static path: into stored energy, and into sliding.

Energies are in mean disk weights times mean radii. A sequence of equilibria has no inertia and no dashpots, so what a
load does and a packing does not store has slid away. Both sides are worked out from different things, which makes
their difference a check: the work from the load and the way of the loaded disks alone, the sliding from the contacts'
tangential forces and the part of their slip that their springs have not taken up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contact import CUT
from ..kernels import statics
from ..state import Contacts, FloatArray, State, wall_normals
from .equilibrium import reaction
from .problem import Problem

#: Part of its limit by which a force may be below it and count as cut: a shorter last step leaves it up to 1 % below.
CUT_LATELY = 0.05


def stored(problem: Problem, state: State, seen: FloatArray | None = None) -> float:
    """Energy of all springs, normal and tangential, and of the weights.

    ``seen`` (dof,) : in motion, the velocities of the last evaluation of forces. A force that was cut to its limit
    there has a spring that makes up for the dashpot; of such a spring the part counts whose force is within the limit.
    """
    total = float(problem.weight @ state.position[:, 1])
    rates: Any = ((0.0, 0.0, 0.0),) * 2 if seen is None else _rates(problem, state, seen)
    cut = seen is not None and problem.rule == CUT
    for (contacts, law, shape, rolling), (apart, slip, turn) in zip(problem.kinds(state), rates, strict=True):
        total += statics.elastic_energy(contacts.overlap, shape, law)
        normal = np.abs(np.maximum(contacts.normal_force - law.normal_damping * apart, law.least_force))
        if law.friction > 0.0:
            spring, limit = contacts.spring, law.friction * normal
            if cut:
                spring = _within(spring, slip, limit, law.tangential_stiffness, law.tangential_damping)
            total += 0.5 * law.tangential_stiffness * float(spring @ spring)
        if rolling is not None:
            spring, limit = contacts.rolling_spring, rolling.friction * normal
            if seen is not None:
                spring = _within(spring, turn, limit, rolling.stiffness, rolling.damping)
            total += 0.5 * rolling.stiffness * float(spring @ spring)
    return total


def _within(spring, slip, limit, stiffness: float, damping: float) -> FloatArray:
    """(m,) springs, without those of contacts cut to their ``limit`` that only make up for what their dashpot pulls."""
    pull = stiffness * spring + damping * slip
    return np.where((np.abs(pull) >= (1.0 - CUT_LATELY) * limit) & (spring * pull < 0.0), 0.0, spring)


def _rates(problem: Problem, state: State, v: FloatArray) -> tuple[tuple[FloatArray, FloatArray, FloatArray], ...]:
    """Rates at which contacts between disks, and at walls, part, slip and turn, each (m,), at velocities ``v``."""
    n, radius, i, j, k = problem.n, problem.packing.radius, state.pairs.first, state.pairs.second, state.walls.first
    u, w = v[:n], v[n : 2 * n]
    spin = v[2 * n :] if problem.rotations else np.zeros(n)
    found = []
    for normal, du, dw, rims, turn in (
        (state.pair_normal().T, u[i] - u[j], w[i] - w[j], radius[i] * spin[i] + radius[j] * spin[j], spin[i] - spin[j]),
        (wall_normals(state.walls.second).T, u[k], w[k], radius[k] * spin[k], spin[k]),
    ):
        found.append((du * normal[0] + dw * normal[1], dw * normal[0] - du * normal[1] - rims, turn))
    arms = problem.pair_arms(i, j), problem.wall_arms(k)
    return tuple((apart, slip, arm * turn) for (apart, slip, turn), arm in zip(found, arms, strict=True))


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
