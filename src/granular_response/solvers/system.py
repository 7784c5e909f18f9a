"""Solutions with the tangent stiffness of a packing: factorisations made, kept, updated and let go.

The tangent at an equilibrium is K = -dF/dq (:mod:`.equations`); contacts that have changed since a factorisation are a
matrix of low rank (``linalg.updated``), in large packings Newton steps are iterations (``linalg.nearby``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ..kernels import transitions
from ..linalg import Eliminated, Factor, Sequence
from ..linalg.updated import Updated
from ..state import FloatArray, State
from .equations import Configuration, Equations, Trial
from .problem import Problem

__all__ = ["OPTIONS", "Configuration", "StaticSystem", "SystemOptions", "Trial"]


@dataclass(frozen=True)
class SystemOptions:
    """Numbers by which the static equations are solved. Forces in mean weights.

    A force counts as none on three levels, a decade apart, so that what one leaves is no event of the next.
    """

    #: Largest force or torque left on any disk at an equilibrium. Displacements of a radius round the force of a
    #: contact of stiffness 3000 by 3e-12.
    tolerance: float = 1e-10
    #: Added to the tangent's diagonal, in units of the normal stiffness: holds disks that nothing holds.
    regularisation: float = 1e-10
    #: Part of the force out of balance that a step by the factorisation of another tangent leaves (2-norms).
    left_over: float = 1e-6
    #: A shift of the diagonal, in units of the normal stiffness, that is below the softest modes of a packing of some
    #: hundred layers. It holds disks that nothing holds and hardly damps others, and solutions by the factorisation of
    #: a matrix make up for it with little effort.
    soft: float = 1e-7
    #: Repetitions after which a search is given up that ends by itself, as a rule long before: one that goes on goes in
    #: a circle. Worst contacts of rates changed 30 times at most, contacts at one load of a path 8 times, and with the
    #: 3/2 law an increment took 12 steps.
    patience: int = 40
    #: Stiffnesses that may have changed since a factorisation: with more, solutions cost more than another one.
    most_changed: int = 40

    @property
    def enough(self) -> float:
        """Force at which Newton's method ends without trying to do better: what displacements of some hundredths of a
        radius round a contact force by."""
        return 1e-3 * self.tolerance

    @property
    def event(self) -> float:
        """By how much a contact force may be away from its event, and how much it must change in a mean weight of load
        to have a part in it: ten times what an equilibrium leaves, which would decide on events otherwise."""
        return 10.0 * self.tolerance

    @property
    def bare(self) -> float:
        """Force up to which a contact bears nothing: what an event may leave out of balance."""
        return 10.0 * self.event


OPTIONS = SystemOptions()


class StaticSystem(Equations):
    """The equations, and solutions with their tangent."""

    def __init__(self, problem: Problem, state: State):
        super().__init__(problem, state)
        self.storage = self.pattern.storage
        self._kept: tuple[np.ndarray, Factor] | None = None
        self._updated: Updated | None = None
        self.renewals = 0  #: factorisations made by :meth:`renewed_factor`
        self._steps = Sequence(self.storage, same=OPTIONS.soft * problem.stiffness)

    def factorise(self, matrix: sp.csc_array) -> Eliminated:
        """LU of a tangent, after those of steps have gone."""
        self.forget()
        return self.storage.factor(matrix)

    def _regularised(self, trial: Trial) -> sp.csc_array:
        """The tangent with a tiny regularisation."""
        return self.tangent(trial, OPTIONS.regularisation * self.problem.stiffness)

    def forget(self) -> None:
        """Let factorisations of steps go before one is made: only that of the rates stays in memory beside it."""
        self._kept = None
        self._steps.forget()

    def step(self, trial: Trial, force: FloatArray, shift: float = 0.0) -> FloatArray:
        """(dof,) displacements that take ``force`` up, by the tangent with ``shift`` on its diagonal.

        Without a shift a disk of which all contacts slide turns as if one of them stuck: nothing else would end its
        turn, which can turn their slip round. In a large packing by iteration, with a rough factorisation that may be
        brought up to date for what has changed since. RuntimeError where the tangent is exactly singular.
        """
        right = self.interleave(force)
        matrix = self.tangent(trial, shift)
        held = np.full((self.problem.n, self.problem.freedoms), OPTIONS.regularisation)
        if shift == 0.0:
            held[:, 2:][self.pattern.without_effect(matrix).reshape(held.shape)[:, 2:]] = 1.0
        matrix.data[self.pattern.diagonal] += held.ravel() * self.problem.stiffness
        self._kept = None
        found = self._steps.solve(matrix, right, OPTIONS.left_over, shift)
        factor: Eliminated | None = self._steps.factor
        if found is None:
            factor = self.factorise(matrix)
            found = factor.solve(right)
        if factor is not None and shift == 0.0:
            self._kept = trial.sense, factor
        return self.deinterleave(found)

    def updated_factor(self, known: Configuration, sense: np.ndarray) -> Updated:
        """The factorisation of the tangent at an equilibrium with signed statuses (m + w,), up to the turn of contacts.

        One that was made before, and what has changed since; made anew where that is too much.
        """
        updated = self._updated
        if updated is None or np.count_nonzero(sense != updated.made) > OPTIONS.most_changed:
            return self.renewed_factor(known, sense)

        def change(contacts: NDArray[np.int64]) -> tuple[np.ndarray, np.ndarray, FloatArray, FloatArray]:
            most = 2 * len(contacts)
            sides = np.zeros((2, most, 6))
            columns = transitions.Columns(np.zeros(most, np.int64), np.zeros((most, 6), np.int64), *sides)
            rows = self.changed_stiffness(
                contacts, updated.made, sense, known.q, self.listed, self.problem.freedoms, self.pattern.place, columns
            )
            owner, places, left, right = columns
            if self.held.size:
                held = np.isin(self.pattern.interleaved[places], self.held)
                left[held], right[held] = 0.0, 0.0
            return owner[:rows], places[:rows], left[:rows], right[:rows]

        if updated.update(sense, change) and updated.accurate:
            return updated
        return self.renewed_factor(known, sense)

    def outdate(self, factor: Updated) -> None:
        """Let the next :meth:`updated_factor` be made anew, if ``factor`` is still the one that it would update."""
        if self._updated is factor:
            self._updated = None

    def renewed_factor(self, known: Configuration, sense: np.ndarray) -> Updated:
        """The same, made anew."""
        self._updated = None
        self.renewals += 1
        matrix = self._regularised(self.trial(known, known.q, fixed=sense))
        self._updated = Updated(self.factorise(matrix), self.dof, OPTIONS.most_changed, 6, sense)
        return self._updated

    def answers(self, trial: Trial, *, transposed: bool = False) -> Callable[[FloatArray], FloatArray]:
        """What gives the (dof,) displacements that take small forces (dof,) up, to the last digits.

        Nothing pushes what is held. Or, ``transposed``, the influence of every unknown on what a row (dof,) measures.
        """
        tangent, regularised = self.tangent(trial), self._regularised(trial)
        if transposed:
            tangent, regularised = self.pattern.transposed(tangent), self.pattern.transposed(regularised)
        factor = self.storage.factor(regularised)

        def answer(force: FloatArray) -> FloatArray:
            free = force.copy()
            free[self.held] = 0.0
            right = self.interleave(free)
            found = factor.solve(right)
            found += factor.solve(right - tangent @ found)  # the tangent was held by a tiny stiffness
            return self.deinterleave(found)

        return answer

    def kept_factor(self, trial: Trial) -> Factor | None:
        """The last factorisation of a tangent, when every contact has the same status (and direction of sliding)."""
        if self._kept is None or not np.array_equal(self._kept[0], trial.sense):
            return None
        return self._kept[1]

    def definite_step(self, trial: Trial, force: FloatArray, shift: float) -> FloatArray | None:
        """(dof,) displacements that take ``force`` up, by the symmetric part of the tangent with ``shift`` added.

        None when it is not positive definite.
        """
        factor = self.storage.definite_factor(self.pattern.symmetric_part(self.tangent(trial, shift)))
        return None if factor is None else self.deinterleave(factor.solve(self.interleave(force)))
