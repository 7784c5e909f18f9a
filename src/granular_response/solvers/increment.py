"""One increment of a quasi-static path: from an equilibrium to the next.

Newton's method with the return map converges in a few steps unless several contacts change their status together
(above all, contacts that begin to slide while their neighbours open): the tangent of a wrong guess of sliding
contacts is nearly a mechanism, and the iteration runs away. Then the Coulomb limits are held fixed at their
last values. With fixed limits the increment has an energy (elastic, plus friction at a known limit), whose
minimum Newton's method with an exact line search finds from anywhere; limits are updated and the minimisation is
repeated. Two or three rounds bring the guess so near that Newton's method finishes on the true law. This fixed
point on the limits is the one of Panagiotopoulos for contact with friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..state import FloatArray
from .equilibrium import OPTIONS as NEWTON
from .equilibrium import newton
from .line_search import shortened
from .system import OPTIONS as SYSTEM
from .system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class IncrementOptions:
    """Numbers that an increment goes by. Forces in mean weights."""

    #: Newton iterations on the true law before limits are held fixed, where none that succeeded took more than 5.
    direct: int = 8
    #: The same after a round of fixed limits, where none took more than 3.
    again: int = 4
    #: Rounds of fixed limits before the true law is tried again, once a round.
    first_try: int = 2
    #: Tries of it that may fail.
    failed: int = 3
    #: Steps of a minimisation with fixed limits: one that takes more goes on for ever.
    steps: int = 15
    #: Unbalanced force below which a minimisation ends when steps have stalled: contacts go to and fro at no force.
    still: float = 1e-5
    #: Steps in turn that have not halved a force, by which steps have stalled.
    stalled: int = 3


OPTIONS = IncrementOptions()


@dataclass
class Work:
    """What increments cost."""

    increments: int = 0
    factorisations: int = 0


def solve_increment(
    system: StaticSystem, known: Configuration, external: FloatArray, guess: FloatArray, work: Work
) -> Trial | None:
    """Equilibrium under ``external``, one increment after ``known``; None where none is found.

    ``guess`` (dof,) is a prediction of the displacements.
    """

    def on_true_law(q: FloatArray, most: int) -> Trial | None:
        trial, report = newton(system, known, external, q, maximum_iterations=most)
        work.factorisations += report.iterations
        work.increments += report.converged
        return trial if report.converged else None

    found = on_true_law(guess, OPTIONS.direct)
    if found is not None or not system.problem.rotations:
        return found
    limits = system.limits(system.trial(known, known.q))
    q = known.q.copy()
    q[system.held] = guess[system.held]
    for done in range(1, OPTIONS.first_try + OPTIONS.failed + 1):
        held = minimise_with_limits(system, known, external, q, limits, work)
        if held is None:
            return None
        q = held.configuration.q
        limits = system.limits(held)
        if done > OPTIONS.first_try and (found := on_true_law(q, OPTIONS.again)) is not None:
            return found
    return None


def minimise_with_limits(
    system: StaticSystem, known: Configuration, external: FloatArray, start: FloatArray, limits: FloatArray, work: Work
) -> Trial | None:
    """The minimum of an increment's energy with fixed Coulomb limits, as near as steps come; None where they go on."""
    q = start
    trial = system.trial(known, q, limits=limits)
    shift = SYSTEM.soft * system.problem.stiffness
    best, stalled = np.inf, 0
    for left in range(OPTIONS.steps, -1, -1):
        r = trial.contact_force + external
        size = float(np.abs(r).max())
        stalled = stalled + 1 if size > 0.5 * best else 0
        best = min(best, size)
        # limits change after it, so that it need not be exact
        if size < 10.0 * SYSTEM.bare or (best < OPTIONS.still and stalled >= OPTIONS.stalled):
            return trial
        if left == 0:
            break
        work.factorisations += 1
        try:
            step = system.step(trial, r, shift)
        except RuntimeError:  # exactly singular
            return trial
        length = float(np.abs(step).max())
        if not np.isfinite(length):
            return trial
        if length > NEWTON.longest_step:
            step *= NEWTON.longest_step / length
        slope = float(r @ step)
        step, trial = shortened(
            system, known, external, q, step, slope, limits=limits, until=NEWTON.flat, beyond=NEWTON.flat
        )
        q = q + step
    return None
