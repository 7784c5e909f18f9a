"""The rate problem: how an equilibrium goes on under a load that grows by a little.

Where contacts keep their status the rates of the displacements ``v`` follow from the tangent, ``K v = f``, with ``f``
the rate of the load. Which statuses these are is part of the problem where contacts are about to change: a contact at
Coulomb's limit slides (its slip has the direction of its force) or sticks (its force does not pass the limit), one that
bears nothing closes or opens. This is the linear complementarity problem of contact with friction in rates
(McNamara and Herrmann, Phys. Rev. E 74, 061303, 2006), solved here by changing the statuses that contradict themselves
until none does: all at once, and where that comes back to statuses that it has tried, the worst ones alone. A contact
that can neither stay open nor stick slides.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ..kernels import transitions
from ..kernels.transitions import CLOSES, OPENS, Changes
from ..linalg.updated import Updated
from ..state import OPEN, SLIDING, STICKING, FloatArray
from .system import OPTIONS as SYSTEM
from .system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class RateOptions:
    """Numbers by which statuses of a rate problem are found."""

    #: Rounds in which all contacts that contradict themselves change, before the worst ones alone do.
    all: int = 8
    #: Part of the largest rate by which rounding may change rates: of the gaps of a disk that bears nothing, where a
    #: tenth of that was seen, of a mirror pair, which is bad together, and of displacements that are to be smaller.
    rounding: float = 1e-3

    @property
    def bare(self) -> float:
        """Force (mean weights) that some events leave at the contacts of a disk that bears nothing."""
        return 10.0 * SYSTEM.bare


OPTIONS = RateOptions()


def next_changes(
    system: StaticSystem, trial: Trial, velocity: FloatArray, sense: np.ndarray, force: float, negligible: float
) -> Changes:
    """What each contact of a trial does next where displacements grow at the rates ``velocity`` (dof,).

    ``sense`` (m + w,) : signed statuses; ``force``, ``negligible`` : a force and a rate of a force that are none.
    """
    found = Changes(*np.empty((3, len(sense))))
    system.next_changes(
        velocity, system.listed, trial.contacts, sense.astype(float), force, negligible, system.count, found
    )
    return found


#: Status after what a contact does next, by that and ``SLIDES``: one that slides under a negative force comes first.
AFTER = np.array([-SLIDING, OPEN, OPEN, OPEN, OPEN, STICKING, SLIDING, STICKING], np.int8)


def changed(sense: np.ndarray, contacts: np.ndarray, what: np.ndarray) -> np.ndarray:
    """Signed statuses (m + w,) after ``contacts`` have done what they do next."""
    new = sense.copy()
    new[contacts] = AFTER[what[contacts].astype(int) + transitions.SLIDES]
    return new


@dataclass(frozen=True)
class Rates:
    """How an equilibrium goes on until the next contact changes, per load factor in the direction of the path."""

    sense: np.ndarray  #: (m + w,) signed statuses with which it does
    factor: Updated
    velocity: FloatArray  #: (dof,)
    changes: Changes

    free: bool  #: whether contacts that bear nothing have opened so that they need not be followed
    idle: np.ndarray  #: unknowns that change no force: angles of disks of which no contact sticks


class RateProblem:
    """Rates of one system on the way to larger (``direction`` 1) or smaller (-1) load factors.

    ``force`` : by which a contact may be away from its change when it changes (mean weights). Contacts of rattlers,
    which open and close at the rounding of a force, have no part in the load, and make no events.
    """

    def __init__(self, system: StaticSystem, direction: float, *, force: float):
        self.system, self.direction, self.force = system, direction, force
        self.negligible = SYSTEM.event * system.problem.load_size
        self._right = system.interleave(direction * system.problem.load_vector)
        self.lifts = bool((system.problem.held.axis == 1).any())  #: whether a load holds the height of a disk
        #: (dof,) rates of what loads hold
        self._held = np.zeros(system.dof)
        self._held[system.held] = direction * system.problem.held.travel

    def velocity(self, known: Configuration, sense: np.ndarray, factor: Updated) -> FloatArray:
        """(dof,) rates of the displacements with signed statuses (m + w,), by the factorisation of their tangent."""
        system = self.system
        if not system.held.size:
            return system.deinterleave(factor.solve_same(self._right))
        rates = system.force_rates(system.trial(known, known.q, fixed=sense), self._held)
        rates[system.held] = 0.0
        return self._held + system.deinterleave(factor.solve(self._right + system.interleave(rates)))

    def changes(self, trial: Trial, velocity: FloatArray, sense: np.ndarray) -> Changes:
        """What each contact does next with signed statuses ``sense`` (m + w,)."""
        return next_changes(self.system, trial, velocity, sense, self.force, self.negligible)

    def until(self, trial: Trial, c: int, what: int, displacement: FloatArray) -> tuple[float, float]:
        """Force (mean weights) left until contact ``c`` does ``what``; by how much a displacement (dof,) lowers it."""
        return self.system.until(c, what, trial.configuration.q, displacement, self.system.listed, trial.contacts)

    def solve(self, trial: Trial, sense: np.ndarray) -> Rates | None:
        """Rates at an equilibrium with statuses that do not contradict themselves; None where none are found.

        ``sense`` (m + w,) : signed statuses to begin with, of contacts whose forces those of the trial go on. Of
        contacts that are equally bad, such as a mirror pair, all change.
        """
        known = trial.configuration
        # one that bears nothing has no slip to go on with
        idle = (np.abs(sense) == SLIDING) & np.concatenate([trial.normal <= self.force] * self.system.rows)
        sense = np.where(idle, np.int8(STICKING), sense)
        ways = (OPTIONS.all, False, False), (SYSTEM.patience, True, False), (SYSTEM.patience, True, True)
        for rounds, worst, anew in ways:  # whether the worst alone change, and whether each tangent is factorised anew
            now, tried = sense, {sense.tobytes()}
            had: dict[int, set[int]] = {}  #: statuses, in these rounds, of contacts that opened or closed
            for _ in range(rounds):
                factored = self.system.renewed_factor if anew else self.system.updated_factor
                try:
                    factor = factored(known, now)
                    velocity = self.velocity(known, now, factor)
                except RuntimeError:  # exactly singular
                    break
                if not np.isfinite(velocity.sum()):
                    break
                found = self.changes(trial, velocity, now)
                due = found.due(self.force)
                if not due.size:
                    rates = Rates(now, factor, velocity, found, False, self.system.idle(trial, now))
                    return self._let_go(trial, rates)
                if worst:
                    fall = found.rate[due]
                    due = due[fall >= (1.0 - OPTIONS.rounding) * fall.max()]
                now = changed(now, due, found.what)
                for c in due.tolist():
                    if found.what[c] not in (OPENS, CLOSES) or not self.system.friction[c] > 0.0:
                        continue
                    # one that neither opens nor sticks slides, often at no force: pushed by a disk that rolls
                    had.setdefault(c, {int(sense[c])})
                    now[c] = next((way for way in (now[c], SLIDING, -SLIDING) if int(way) not in had[c]), now[c])
                    had[c].add(int(now[c]))
                now = self.system.coupled(now)
                if now.tobytes() in tried:
                    break
                tried.add(now.tobytes())
        return None

    def _let_go(self, trial: Trial, rates: Rates) -> Rates:
        """The same with less motion, where contacts open that bear nothing and go on so.

        A disk that nothing resists could follow another one at such a contact for ever. It stays. Only a disk whose
        height a load holds can bear nothing; rattlers bear their weight.
        """
        if not self.lifts:
            return rates
        sense, velocity, known = rates.sense, rates.velocity, trial.configuration
        closed = sense[: len(trial.normal)] != OPEN
        bare = np.flatnonzero((trial.normal <= OPTIONS.bare) & closed)
        if bare.size:
            apart = np.abs([self.until(trial, int(c), OPENS, velocity)[1] for c in bare])
            # rates are those of next to no stiffness where a disk bears nothing at all, and rounding is large
            rough = OPTIONS.rounding * self.system.problem.stiffness * np.abs(velocity).max()
            rests = trial.normal[bare] <= self.force
            least = np.where(rests, self.negligible, -1.0)
            bare = bare[apart <= np.where(self._bears_nothing(trial, bare), rough, least)]
        if not bare.size:
            return rates
        opened = sense.copy()
        opened[bare] = OPEN
        opened = self.system.coupled(opened)
        with suppress(RuntimeError):
            factor = self.system.updated_factor(known, opened)
            less = self.velocity(known, opened, factor)
            changes = self.changes(trial, less, opened)
            smaller = np.linalg.norm(less) < (1.0 - OPTIONS.rounding) * np.linalg.norm(velocity)
            if smaller and not changes.due(self.force).size:
                return Rates(opened, factor, less, changes, True, self.system.idle(trial, opened))
        return replace(rates, factor=self.system.updated_factor(known, sense))

    def _bears_nothing(self, trial: Trial, contacts: np.ndarray) -> np.ndarray:
        """Of each of ``contacts`` whether no contact of one of its disks bears a force: a load holds that disk."""
        borne = np.append(self.system.state(trial, 0.0).largest_normal_force(), np.inf)  # at last of walls, disk -1
        return borne[self.system.listed.disks[contacts]].min(axis=1) <= OPTIONS.bare
