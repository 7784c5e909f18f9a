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
    rates: Any = ((0.0,) * 3,) * 2 if seen is None else _rates(problem, state, seen)
    for (contacts, laws, shape), (apart, *slips) in zip(problem.kinds(state), rates, strict=True):
        law = laws[0]
        total += statics.elastic_energy(contacts.overlap, shape, law)
        normal = np.abs(np.maximum(contacts.normal_force - law.normal_damping * apart, law.least_force))
        for row, (one, spring, slip) in enumerate(zip(laws, contacts.springs, slips, strict=False)):
            if one.friction > 0.0:
                if seen is not None and (row > 0 or problem.rule == CUT):
                    spring = _within(spring, slip, one.friction * normal, one)
                total += 0.5 * one.tangential_stiffness * float(spring @ spring)
    return total


def _within(spring, slip, limit, law: Any) -> FloatArray:
    """(m,) springs, without those of contacts cut to their ``limit`` that only make up for what their dashpot pulls."""
    pull = law.tangential_stiffness * spring + law.tangential_damping * slip
    return np.where((np.abs(pull) >= (1.0 - CUT_LATELY) * limit) & (spring * pull < 0.0), 0.0, spring)


def _rates(problem: Problem, state: State, v: FloatArray) -> tuple[tuple[FloatArray, FloatArray, FloatArray], ...]:
    """Rates at which contacts between disks, and at walls, part, and slip in each row, each (m,), at velocities v."""
    n, radius, i, j, k = problem.n, problem.packing.radius, state.pairs.first, state.pairs.second, state.walls.first
    u, w = v[:n], v[n : 2 * n]
    spin = v[2 * n :] if problem.rotations else np.zeros(n)
    found = []
    for normal, du, dw, rims, turn in (
        (state.pair_normal().T, u[i] - u[j], w[i] - w[j], radius[i] * spin[i] + radius[j] * spin[j], spin[i] - spin[j]),
        (wall_normals(state.walls.second).T, u[k], w[k], radius[k] * spin[k], spin[k]),
    ):
        found.append((du * normal[0] + dw * normal[1], dw * normal[0] - du * normal[1] - rims, turn))
    arms = problem.arms(i, j, k)
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
    """Energy that sliding took between two states, in all rows.

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
    slip = distance * turn - radius[i] * turned[i] - radius[j] * turned[j]
    arm, wall_arm = problem.arms(i, j, k)
    pairs = _lost(before.pairs, after.pairs, slip, arm * (turned[i] - turned[j]))
    walls = _lost(before.walls, after.walls, along - radius[k] * turned[k], wall_arm * turned[k])
    return Slid(pairs, walls)


def _lost(before: Contacts, after: Contacts, *slips: FloatArray) -> FloatArray:
    """(m,) mean force in each row times the part of its slip (m,) that the springs have not taken up, in all."""
    closed = np.where(before.touching & after.touching, 1.0, 0.0)
    for one, other in ((before, after), (after, before)):
        half = one.touching & ~other.touching
        closed[half] = one.overlap[half] / (one.overlap[half] - other.overlap[half])
    mean = 0.5 * (before.forces + after.forces)
    return (-mean * (closed * np.stack(slips) - (after.springs - before.springs))).sum(axis=0)
