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

from ..linalg import Factor
from ..scene.arrays import LEAST_MASS
from ..state import OPEN, FloatArray
from .system import OPTIONS as SYSTEM
from .system import StaticSystem, Trial


@dataclass(frozen=True)
class FreeOptions:
    """Numbers by which motions without resistance are told from soft ones."""

    #: Displacement per force, over that along a null direction, from which on a step may go along one: the softest
    #: directions of packings have up to 1e-5.
    soft: float = 1e-3
    #: Times that the tangent's inverse takes from a random vector what some stiffness resists: at the default stiffness
    #: a direction of 1e-4 mean weights per mean radius keeps 3e-8 of itself, a null direction all.
    times: int = 3
    #: What a random vector keeps of itself at disks that do not move freely, at most.
    part: float = 1e-6


OPTIONS = FreeOptions()

#: Force (mean weights) along a null direction up to which it is a residual, and moves nothing. The lightest disk that
#: is allowed weighs more, and falls.
RESIDUAL = 0.1 * LEAST_MASS


def suspicious(system: StaticSystem, step: float, force: float) -> bool:
    """Whether a ``step`` is so large for its ``force`` that it may go along a direction that nothing resists."""
    return step * SYSTEM.regularisation * system.problem.stiffness > OPTIONS.soft * force


def least(system: StaticSystem, solve: Callable[[FloatArray], FloatArray], step: FloatArray) -> FloatArray:
    """``step`` (dof,) without its part along null directions, by what solves with the regularised tangent.

    That multiplies what lies along one by the inverse of the regularisation, anything else by next to nothing of it.
    """
    return step - SYSTEM.regularisation * system.problem.stiffness * solve(step)


def least_at_rest(
    system: StaticSystem, solve: Callable[[FloatArray], FloatArray], step: FloatArray, force: FloatArray
) -> FloatArray:
    """The same where the forces out of balance (dof,) are no more than a residual along null directions; else ``step``:
    a disk in the air falls along one."""
    along = SYSTEM.regularisation * system.problem.stiffness * solve(force)
    return least(system, solve, step) if float(np.abs(along).max()) <= RESIDUAL else step


def without_bare(system: StaticSystem, trial: Trial) -> Trial | None:
    """The trial with its contacts open that bear nothing: they are no ties. None where there are none."""
    bare = (trial.status != OPEN) & (trial.normal <= SYSTEM.bare)
    if not bare.any():
        return None
    sense = trial.sense.copy()
    sense[: len(bare)][bare] = OPEN
    return system.trial(trial.configuration, trial.configuration.q, fixed=system.coupled(sense))


def solved_by(system: StaticSystem, factor: Factor) -> Callable[[FloatArray], FloatArray]:
    """What solves for displacements (dof,) by a factorisation."""
    return lambda force: system.deinterleave(factor.solve(system.interleave(force)))


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
    # what is left of a random vector along null directions
    left = np.random.default_rng(0).standard_normal(system.dof)
    for _ in range(OPTIONS.times):
        left = regularised * factor.solve(left)
        if float(np.abs(left).max()) < OPTIONS.part:
            return ()
    size = np.abs(system.deinterleave(left)).reshape(-1, problem.n).max(axis=0)
    return tuple(np.flatnonzero(size > OPTIONS.part).tolist())
