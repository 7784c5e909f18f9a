"""From a point to where the next contact changes, in ever shorter increments: Newton's method with kept statuses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from ...kernels import transitions
from ...linalg.updated import Updated
from ...state import FloatArray
from ..equilibrium import OPTIONS as NEWTON
from ..equilibrium import attainable, external_force
from ..free import least, solved_by, suspicious
from ..rates import Rates, changed
from ..system import OPTIONS as SYSTEM
from ..system import Trial
from .points import Leg, Point, largest


@dataclass(frozen=True)
class Aim:
    """An increment to try: to the change of a contact if that comes first, else as far as ``most``. In load factors."""

    most: float
    length: float  #: until the contact changes by its rate; infinity where no change is aimed at
    contact: int
    what: int
    passed: float = np.inf  #: length within which a contact is known to change

    def shorter(self, most: float) -> Aim:
        return replace(self, most=most, length=np.inf)


def landed(leg: Leg, point: Point, rates: Rates) -> Point | None:
    """Where the next contact changes, or the target or the end of the longest increment if that comes first."""
    fastest, left = largest(rates.velocity[: 2 * leg.problem.n]), abs(leg.target - point.factor)
    if fastest * left > leg.options.listed_again:
        left = leg.options.listed_again / fastest
    contact, length = transitions.first_change(rates.changes.left, rates.changes.rate)
    aim = Aim(left, length, contact, int(rates.changes.what[contact]) if np.isfinite(length) else transitions.NOTHING)
    # shorter each time: to an event before the one expected, or half as long where there is no equilibrium at the end
    for _ in range(SYSTEM.patience):
        tried = _tried(leg, point, rates, aim)
        if not isinstance(tried, Aim):
            return tried
        aim = tried
    return None


def _tried(leg: Leg, point: Point, rates: Rates, aim: Aim) -> Point | Aim | None:
    """Where an increment ends, or the next to try; None where there is none."""
    event = (aim.contact, aim.what) if aim.length < aim.most else None
    length, force = min(aim.length, aim.most), point.rate_problem.force
    found = smooth(leg, point, rates, length, event)
    if found is None:
        return aim.shorter(0.5 * length) if 0.5 * length * leg.unit >= leg.options.beyond else None
    factor, trial, steps = found
    ahead, way = leg.direction * (factor - point.factor), abs(factor - point.factor)
    if event is not None and ahead * leg.unit < -force:
        return aim.shorter(0.5 * length)  # another branch: the load would go back
    if event is not None and ahead > aim.most:
        # the contact changes later than its rate said; or this is another branch, if it changes before
        return aim.shorter(0.5 * aim.most if aim.most == aim.passed else aim.most)
    # whether rates are found at the end too: those of the start may be off by what contacts have turned since
    again, velocity = leg.varying or trial.contradiction > force, rates.velocity
    if again:
        _, velocity = _renewed(point, trial, rates.sense)
        if event is not None and float(velocity @ rates.velocity) < 0.0:
            return aim.shorter(0.5 * length)  # another branch, beyond a limit point of the load
    then = point.rate_problem.changes(trial, velocity, rates.sense)
    due = then.due(force)
    passed = due[then.left[due] < -force]
    if passed.size:  # another contact came first
        back = -then.left[passed] / then.rate[passed]
        contact, before = int(passed[np.argmax(back)]), max(way - float(back.max()), 0.0)
        other = Aim(way, before, contact, int(then.what[contact]), passed=way)
        # or, if it is the one that was aimed at, Newton's method has let it go
        return other.shorter(0.5 * way) if event is not None and contact == aim.contact else other
    if again and (turn := _turn(leg, point, rates, then, way)) is not None:
        return aim.shorter(turn)
    # force of a spring from the bend of its contact's way: it falls as the third power of the length
    if (bent := leg.stiffest * trial.bend) > SYSTEM.bare:
        return aim.shorter(min(0.5, 0.8 * (SYSTEM.bare / bent) ** (1 / 3)) * way)
    if steps > leg.options.outdated:
        point.system.outdate(rates.factor)
    if not again:  # what the rates of the start say of contacts that bear nothing is the turn on the way
        due = due[(rates.changes.rate[due] > 0.0) | (due == aim.contact)]
    after = point.system.coupled(changed(rates.sense, due, then.what))
    negative = rates.factor.negative_pivots
    return Point(point.rate_problem, factor, trial, rates.sense, after, rates.velocity, negative, point.unstable)


def _renewed(point: Point, trial: Trial, sense: np.ndarray) -> tuple[Updated | None, FloatArray]:
    """Factorisation of the tangent at a trial and the (dof,) rates by it; None and zeros where it is singular."""
    try:
        factor = point.system.renewed_factor(trial.configuration, sense)
        return factor, point.rate_problem.velocity(trial.configuration, sense, factor)
    except RuntimeError:
        return None, np.zeros(point.system.dof)


def _turn(leg: Leg, point: Point, rates: Rates, then: transitions.Changes, length: float) -> float | None:
    """Where the first slip has turned round within an increment of a ``length``, by less than a force; or None."""
    until, force = point.rate_problem.until, point.rate_problem.force
    back = np.flatnonzero((then.what == transitions.STICKS) & (then.rate > 0.0))
    way = np.where(rates.sense[back] > 0, transitions.SLIDES, -transitions.SLIDES)
    falls = zip(back.tolist(), way.tolist(), strict=True)
    ahead = np.array([max(until(point.trial, c, w, rates.velocity)[1], 0.0) for c, w in falls])
    turns = length * ahead / (ahead + then.rate[back])  # were the rate of slip linear
    late = 0.5 * then.rate[back] * (length - turns) > force
    for k in np.flatnonzero(late)[np.argsort(turns[late], kind="stable")]:
        c, w = int(back[k]), int(way[k])

        @cache  # the ends are asked for twice
        def slip(part: float, c: int = c, w: int = w) -> float:
            found = (point.factor, point.trial, 0) if part == 0.0 else smooth(leg, point, rates, part, None)
            return -1.0 if found is None else until(found[1], c, w, _renewed(point, found[1], rates.sense)[1])[1]

        # slip beyond its turn grows as the square of the length
        beyond = float(np.sqrt(force * length / (ahead[k] + then.rate[c])))
        if slip(0.0) > 0.0 and slip(length) >= 0.0:
            return 0.5 * length  # the event that was found lies on another branch, beyond a limit point
        from scipy.optimize import brentq  # a tenth of a second at the start of every process, and rare

        turn = float(brentq(slip, 0.0, length, xtol=0.25 * beyond)) if slip(0.0) > 0.0 else 0.0
        if length > turn + 1.5 * beyond:
            return turn + beyond
    return None


def smooth(
    leg: Leg, point: Point, rates: Rates, length: float, event: tuple[int, int] | None
) -> tuple[float, Trial, int] | None:
    """Load factor, equilibrium with the statuses of ``rates`` a ``length`` on, and the Newton steps that took.

    With an ``event``, a contact and what it does, the load factor is an unknown too: that at which the contact does
    it. Newton's method by the tangent at ``point``, or by that of an iterate where it does not lead there soon.
    """
    system, until, force_off = point.system, point.rate_problem.until, point.rate_problem.force
    known, by, velocity = point.known, rates.factor, rates.velocity
    at_end = event is None and length >= abs(leg.target - point.factor)
    factor = leg.target if at_end else point.factor + leg.direction * length
    q = system.displaced(known.q + abs(factor - point.factor) * velocity, factor)
    before, enough, stalled = np.inf, SYSTEM.enough if event is None else leg.passing, False
    for done in range(SYSTEM.patience):
        along = abs(factor - point.factor)
        trial = system.trial(known, q, fixed=rates.sense, velocity=rates.velocity, length=along)
        force = trial.contact_force + external_force(leg.problem, factor)
        if leg.free:
            force = leg.resisted(system, by, force)
        size = largest(force)
        left, rate = (0.0, 0.0) if event is None else until(trial, *event, velocity)
        if not np.isfinite(size):
            return None
        rounding = size > 0.5 * before and size <= attainable(system, q)
        # a contact that began to slide a little early leaves a torque on a disk of which all contacts slide
        left_over = stalled and size > leg.options.slow * before and size <= force_off
        if (size <= enough or rounding or left_over) and abs(left) <= 0.5 * force_off:
            return factor, trial, done
        stalled = size > leg.options.slow * before
        if stalled or done % leg.options.same_tangent == leg.options.same_tangent - 1:
            renewed, velocity = _renewed(point, trial, rates.sense)
            if renewed is None:
                return None
            by = renewed
            velocity[rates.idle] = rates.velocity[rates.idle]
            if event is not None:
                _, rate = until(trial, *event, velocity)
        before = size
        step = system.deinterleave(by.solve(system.interleave(force)))
        step[rates.idle] = 0.0  # it would be the rounding of a torque over next to no stiffness
        longest = largest(step[: 2 * leg.problem.n])
        if leg.free or suspicious(system, longest, size):
            step = least(system, solved_by(system, by), step)
            step[rates.idle] = 0.0
            longest = largest(step[: 2 * leg.problem.n])
        if longest > NEWTON.longest_step:  # a contact of the 3/2 law that has just closed has no stiffness yet
            step *= NEWTON.longest_step / longest
        if event is not None and rate <= 0.0:  # it does not come nearer: on with new rates from here
            event = None
        elif event is not None:
            further = (left - until(trial, *event, step)[1]) / rate
            factor += leg.direction * further
            step += further * velocity
        q = system.displaced(q + step, factor)
    return None
