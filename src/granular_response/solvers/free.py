"""Motions that nothing resists: which disks they move.

Along a null direction of the tangent K no force changes, so that equilibrium does not say how far a packing has gone
along it: a disk without contacts, one that rolls on the floor, disks that roll on each other like gears. The solutions
of Newton's method are held along such directions by a tiny stiffness alone, and a residual over that is a displacement
that means nothing: :func:`least` takes it out of a step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..state import OPEN, FloatArray
from .system import OPTIONS as SYSTEM
from .system import StaticSystem, Trial


@dataclass(frozen=True)
class FreeOptions:
    """Numbers by which motions without resistance are told from soft ones."""

    #: Displacement per force, in units of the inverse normal stiffness, from which on a step may go along a null
    #: direction: the softest directions of packings have up to 1e5, a null direction 1e10.
    soft: float = 1e7
    #: Stiffness below which a direction is free (mean weights per mean radius); rounding makes 1e-10 of none.
    stiffness: float = 1e-6
    #: Normal force (mean weights) up to which a contact bears nothing, as of ``PathOptions.passing``: it is no tie, since
    #: it may open.
    bare: float = 1e-8
    #: Part of a free motion below which a disk does not take part in it.
    part: float = 1e-6
    #: Directions that are looked for at once, doubled while all of them are free.
    block: int = 8


OPTIONS = FreeOptions()


def suspicious(system: StaticSystem, step: float, force: float) -> bool:
    """Whether a ``step`` is so large for its ``force`` that it may go along a direction that nothing resists."""
    return step * system.problem.stiffness > OPTIONS.soft * force


def least(system: StaticSystem, solve: Callable[[FloatArray], FloatArray], step: FloatArray) -> FloatArray:
    """``step`` (dof,) without its part along null directions, by what solves with the regularised tangent.

    That multiplies what lies along one by the inverse of the regularisation, anything else by next to nothing of it.
    """
    return step - SYSTEM.regularisation * system.problem.stiffness * solve(step)


def without_bare(system: StaticSystem, trial: Trial) -> Trial | None:
    """The trial with its contacts open that bear nothing; None where there are none."""
    bare = (trial.status != OPEN) & (trial.normal <= OPTIONS.bare)
    if not bare.any():
        return None
    sense = trial.sense.copy()
    sense[: len(bare)][bare] = OPEN
    return system.trial(trial.configuration, trial.configuration.q, fixed=system.coupled(sense))


def touched(system: StaticSystem, trial: Trial) -> bool:
    """Whether each disk has a closed contact."""
    closed, at_wall = system.split(trial.status != OPEN)
    ties = np.concatenate([system.first[closed], system.second[closed], system.wall_disk[at_wall]])
    return bool(np.bincount(ties, minlength=system.problem.n).all())


def free_disks(system: StaticSystem, trial: Trial) -> tuple[int, ...]:
    """Disks that a motion moves which changes no force, with the statuses of a trial.

    Turns of disks whose contacts all slide, and the packing as a whole where nothing holds it along x, do not count.
    """
    problem, places = system.problem, system.pattern
    regularised = SYSTEM.regularisation * problem.stiffness
    matrix = system.tangent(trial)
    idle = places.without_effect(matrix).reshape(problem.n, problem.freedoms)
    idle[:, :2] = False
    matrix.data[places.diagonal] += np.where(idle.ravel(), problem.stiffness, 0.0)
    factor = system.storage.factor(places.with_shift(matrix, regularised))
    random = np.random.default_rng(0)
    probe = factor.solve(random.standard_normal(system.dof))
    if not suspicious(system, float(np.abs(probe).max()), 1.0):
        return ()
    count = OPTIONS.block
    while True:
        count = min(count, system.dof)
        found = random.standard_normal((count, system.dof))
        for _ in range(2):
            found = np.linalg.qr(factor.solve(found).T)[0].T
        _, stiffness, ways = np.linalg.svd(matrix @ found.T, full_matrices=False)
        free = ways[stiffness < OPTIONS.stiffness] @ found
        if len(free) < count or count == system.dof:
            break
        count *= 2
    moved = np.stack([system.deinterleave(way) for way in free]) if len(free) else np.zeros((0, system.dof))
    size = np.sqrt((moved.reshape(len(moved), problem.freedoms, problem.n) ** 2).sum(axis=(0, 1)))
    return tuple(np.flatnonzero(size > OPTIONS.part).tolist())
