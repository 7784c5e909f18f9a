"""Overlaps of disks: which are too deep, and given disks without theirs, for places that were measured.

Noise of a measurement presses some disks into each other, and their contacts into springs that hold far more than
gravity: a packing in balance is then thrown about. Here overlapping disks are pushed apart first, by a relaxation
without friction, weights and inertia: each disk moves by half its overlaps, away from the disks and walls that it
overlaps with, and by half of its last step, until no overlap is left that could move anything. So disks that touch
nothing stay where they are, and others move by about the noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..scene import Packing, SceneError
from ..state import FloatArray, State
from ..state.box import WALL_NORMAL, bodies
from .candidates import SKIN
from .close_pairs import close_pairs

if TYPE_CHECKING:
    from .problem import Problem


@dataclass(frozen=True)
class RemovalOptions:
    """Numbers by which overlaps are taken out. Lengths in mean radii."""

    #: Overlap that is left. A contact of stiffness 1e6 mg / mean radius that holds it could lift a disk by 0.005.
    left: float = 1e-4
    #: Part of its last step, and of what would take its overlaps out, by which a disk moves: faster steps throw disks
    #: farther.
    part: float = 0.5
    #: Most steps.
    steps: int = 20_000


OPTIONS = RemovalOptions()

#: Part of the smaller radius from which on an overlap at the start is named where disks do not stay where they were
#: given: at the default stiffness its contact bears 30 mg and throws a disk up by 0.15 radii.
OVERLAPS_OF_NOISE = 0.01


def too_deep(problem: Problem, state: State, part: float = 1.0) -> str:
    """Which two bodies overlap most, where disks overlap by ``part`` of the smaller radius or more, or a disk and a
    wall by that."""
    radius, worst, said = problem.packing.radius, part, ""
    for contacts, size, at_wall in (
        (state.pairs, np.minimum(radius[state.pairs.first], radius[state.pairs.second]), False),
        (state.walls, radius[state.walls.first], True),
    ):
        depth = contacts.overlap / size
        if len(depth) and depth.max() >= worst:
            k = int(depth.argmax())
            two = bodies(contacts.first[k], contacts.second[k], at_wall)
            worst, said = depth[k], f"{two} overlap by {contacts.overlap[k]:.3g} mean radii"
    return said


def overlap_at_start(problem: Problem) -> str:
    """The largest overlap with which given disks begin that is one of :data:`OVERLAPS_OF_NOISE`, and what to do.

    Disks that are given with the springs of their contacts overlap in equilibrium.
    """
    if problem.packing.given is None or problem.packing.contacts is not None:
        return ""
    deep = too_deep(problem, problem.bare_state(), OVERLAPS_OF_NOISE)
    return deep and f"{deep} at the start, which packing.overlaps: removed takes out gently"


def without_overlaps(packing: Packing) -> Packing:
    """The packing with its disks pushed apart; the places that were given are kept beside them.

    Raises SceneError where overlaps are left after ``RemovalOptions.steps``.
    """
    position, box, radius = packing.position.copy(), packing.box, packing.radius
    step = np.zeros_like(position)
    listed = position
    first, second = close_pairs(position, radius, SKIN, box.period)
    for _ in range(OPTIONS.steps):
        if np.abs(position - listed).max() > 0.25 * SKIN:
            listed = position
            first, second = close_pairs(position, radius, SKIN, box.period)
        push, largest = _push(packing, position, first, second)
        if largest <= OPTIONS.left:
            return replace(packing, position=position)
        step = OPTIONS.part * (step + push)
        position = position + step
    raise SceneError(
        f"packing.overlaps = 'removed': an overlap of {largest:.2g} mean radii is left after {OPTIONS.steps} steps, "
        "the disks have no room"
    )


def _push(packing: Packing, position: FloatArray, first, second) -> tuple[FloatArray, float]:
    """(n, 2) half the overlaps of each disk with others and all of those with walls, and the largest overlap."""
    box, radius, n = packing.box, packing.radius, packing.n
    apart = box.separation(position[first], position[second])
    distance = np.sqrt((apart * apart).sum(axis=1))
    overlap = radius[first] + radius[second] - distance
    deep = np.flatnonzero(overlap > 0.0)
    largest = float(overlap.max(initial=0.0))
    first, second = first[deep], second[deep]
    half = apart[deep] * (0.5 * overlap[deep] / np.maximum(distance[deep], 1e-12))[:, None]
    push = np.zeros((n, 2))
    for axis in (0, 1):
        push[:, axis] = np.bincount(first, half[:, axis], n) - np.bincount(second, half[:, axis], n)
    for wall in box.walls:
        inside = np.maximum(-box.wall_gap(position, radius, np.array(wall)), 0.0)
        push += inside[:, None] * WALL_NORMAL[wall]
        largest = max(largest, float(inside.max()))
    return push, largest
