"""Quasi-static loading: from one contact event to the next (the limit of infinitely slow ramps).

Between two events no contact changes its status, so the equations of equilibrium are smooth and their solution under
any increment of the load is exact. The path goes (Oron and Herrmann, Phys. Rev. E 58, 2079, 1998, do the same for
frictionless arrays):

1. :class:`.rates.RateProblem` gives the statuses with which the equilibrium goes on, and the rates of displacements;
2. the load at which the next contact changes follows from the rates; Newton's method with the statuses as they are
   finds equilibrium there, and by the way the load at which the change is exact to ``PathOptions.event``; where the
   return map would give another force than a status that was kept, the rates at the end tell what changed on the way,
   and slip that turned round is bracketed;
3. contacts that are at their change change, a mirror pair together, and so on from 1.

An equilibrium is lost where the rates have no solution, where there is no equilibrium a little further with these
statuses (a snap-through), or where the tangent has an unstable direction along which the contacts that slide go on
sliding (divergence; at a bifurcation of a symmetric branch). The next one is looked for nearby under a slightly larger
load, with the limits of friction held fixed (:func:`.increment.solve_increment`); where there is none the motion of the
disks leads to it (:mod:`.settle`). All are events of the result.

In packings too large for a banded factorisation events are taken together within an increment of the load; what that
leaves out is estimated by a path in increments of twice the length: no bound, since both may miss the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ..errors import SolveError
from ..kernels import events
from ..linalg.lowest import Eigenpair
from ..linalg.updated import Updated
from ..state import OPEN, ROLLING_EVENTS, SLIDING, STICKING, Event, FloatArray, Reached, State
from .dynamics import DynamicsError, Stop
from .equilibrium import OPTIONS as NEWTON
from .equilibrium import attainable, certify, external_force
from .increment import Work, solve_increment
from .problem import Problem
from .rates import Changes, RateProblem, Rates, changed
from .settle import CROSSING, CROSSING_STOP, NotSettled, nudged, settle
from .stability import Clustered, Spectrum, divergence, diverging
from .system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class PathOptions:
    """Numbers that a path goes by. Forces and loads in mean weights, lengths in mean radii."""

    #: Force by which a contact may be away from its event when it changes its status: what a path of a thousand events
    #: leaves of them is 1e-8 of a load of some weights.
    event: float = 1e-9
    #: Rate of a contact force, per load, below which the contact has no part in the load: rattlers, whose contacts open
    #: and close at the rounding of a force, make no events.
    negligible: float = 1e-9
    #: Newton steps with one factorisation, and part of the residual that a step may leave; two or three are usual.
    same_tangent: int = 6
    slow: float = 0.3
    #: Force of a spring from the bend of its contact's way within an increment, above which that is shortened; what is
    #: left of it is smaller, and falls as the third power of the length.
    bent: float = 1e-8
    #: Unbalanced force that is left at an event. The next increment takes it up, so that it does not add up. In the
    #: slabs of the benchmarks events are off by 5e-10 in the median, and wall forces at the end by 3e-10 at most.
    passing: float = 1e-8
    #: Newton steps of a landing above which the next rates have a factorisation of their own. Those of an old one miss
    #: events, and a landing is then tried again; a lower number asks for more factorisations than that spares.
    outdated: int = 2
    #: Newton steps of an increment; with the 3/2 law, whose stiffness changes on the way, up to 12 were needed.
    newton: int = 40
    #: Times that an increment is shortened: to an event that came before the one expected, or to half of its length
    #: where no equilibrium is found at its end.
    landings: int = 40
    #: Points at one load after which no more are looked for there; 8 in turn were the most that led on.
    still: int = 30
    #: Load by which the next equilibrium is looked for, with limits of friction held fixed, where no statuses are found
    #: for the rates; doubled while the path does not go on after it, or it would take as many steps as a slab has loads
    #: of this size. In lattices the path mostly goes on there, only with other statuses.
    beyond: float = 1e-4
    #: Displacement up to which such an equilibrium counts as the next one; farther ones are for the motion to find.
    nearby: float = 1e-3
    #: Load to which the loss of stability between two events is found.
    stability: float = 1e-6
    #: Load by which the motion goes on where an equilibrium is lost, doubled while the path does not go on after it.
    jump: float = 0.01
    #: Displacement after which candidates are listed again, and longest in one increment; the two together are below
    #: half of the largest gap listed.
    listed_again: float = 0.12
    #: Increment of a large packing that takes events together: this times the square root of the number of disks, since
    #: a deeper packing takes more load to change as many contacts; and at most ``longest``.
    together: float = 0.0033
    longest: float = 3.2


#: As measured in docs/benchmarks.md.
OPTIONS = PathOptions()

#: What an event along the tangent is called along the rolling.
ROLLING = dict(zip(("slides", "sticks", "reverses"), ROLLING_EVENTS, strict=True))


class PathError(SolveError, RuntimeError):
    """The load path could not be continued."""


class Collapsed(SolveError, RuntimeError):
    """The load has pushed its disk down farther than allowed, to ``height``."""

    def __init__(self, load: float, height: float) -> None:
        super().__init__(f"the loaded disk sinks to height {height:.3g} on the way to load {load:g}")
        self.height = height


@dataclass
class PathRecord:
    """What a load path has cost, and its events so far."""

    work: Work = field(default_factory=Work)
    events: list[Event] = field(default_factory=list)


@dataclass(frozen=True)
class Point:
    """An equilibrium on a path."""

    factor: float
    trial: Trial
    sense: np.ndarray  #: (m + w,) signed statuses of the increment that ends here
    due: np.ndarray  #: (m + w,) those with which the rate problem begins

    @property
    def known(self) -> Configuration:
        return self.trial.configuration


def follow(
    problem: Problem,
    start: State,
    factors: Sequence[float],
    *,
    together: float | None = None,
    lowest: float = -np.inf,
    progress: Callable[[float], None] | None = None,
    record: PathRecord | None = None,
) -> list[State]:
    """States at the load ``factors`` in turn, growing or falling, reached through every load between.

    Parameters
    ----------
    problem : with its loads chosen.
    start : certified state; a path may start from any of the states it returned, also from a file, and then goes on to
        the last bit as if it had not been cut.
    factors : multipliers of the loads, in turn.
    together : load (mean weights) within which events are taken together, with the return map of whole increments;
        by default none, but in large packings.
    lowest : height below which the first loaded disk must not sink.
    record : what the path costs, and its events; by default goes on from what ``start`` has cost.

    Raises
    ------
    Collapsed
        When the first loaded disk sinks below ``lowest``.
    DynamicsError
        When the motion from a lost equilibrium blows up, or the load carries a disk off.
    PathError
        When the motion does not settle either: the packing collapses or cycles under this load.
    """
    spent = Work(start.reached.increments or 0, start.reached.factorisations or 0)
    path = _Path(problem, together, lowest, record or PathRecord(spent), progress)
    return list(accumulate(map(float, factors), path.to, initial=start))[1:]


class _Path:
    """One load path; nothing is remembered from one kept state to the next but what it has cost."""

    def __init__(self, problem, together, lowest, record, progress):
        self.problem: Problem = problem
        self.record: PathRecord = record
        self.progress: Callable[[float], None] | None = progress
        self.asked, self.lowest = together, lowest
        self.unstable: Eigenpair | None = None  #: the negative eigenvalue that was found last
        self.unit = problem.load_size
        laws = problem.pair_law, problem.wall_law
        self.stiffest = max(law.tangential_stiffness for law in laws)
        #: whether the stiffness of contacts varies with their overlap
        self.varying = any(law.stiffest(2.0) != law.stiffest(1.0) for law in laws)

    def to(self, start: State, target: float) -> State:
        """The state at load factor ``target`` on the way from ``start``."""
        if target == start.load_factor and start.reached.certificate is not None and start.certificate.stable:
            return replace(start, reached=replace(start.reached, events=()))
        self.begun, self.start = len(self.record.events), start
        self.target, self.direction = target, 1.0 if target >= start.load_factor else -1.0
        self.jump, self.beyond = OPTIONS.jump / self.unit, OPTIONS.beyond / self.unit
        self.together = self.asked or None
        point = self._at(start)
        if self.asked is None and self.system.pattern.dissected:
            self.together = min(OPTIONS.together * self.problem.n**0.5, OPTIONS.longest)
        if self.together is not None:  # in two increments at least, or there are none of twice the length
            self.together = min(self.together, 0.5 * self.unit * abs(target - start.load_factor))
        self.guide = {}
        self.reported = start.load_factor
        state = self._followed(point, start)
        if self.together is None or point.factor == target:
            return state
        # what increments leave out, from those of twice the length, whose guesses are what these found
        once, self.together, self.guide = self.together, 2.0 * self.together, self.passed
        error = np.inf
        with suppress(SolveError):
            coarse = self._followed(self._at(start), start)
            if coarse.walls.same_candidates(state.walls):
                off = np.abs(state.wall_force() - coarse.wall_force()).max(initial=0.0)
                error = float(off) / (self.unit * abs(target - start.load_factor))
        self.record.events[self.begun :] = state.reached.events
        work = self.record.work
        reached = replace(state.reached, increments=work.increments, factorisations=work.factorisations)
        reached = replace(reached, events_within=once, events_error=error)
        return replace(state, reached=reached)

    def _followed(self, point: Point, start: State, watched: bool = False) -> State:
        """The certified state at the target, from ``point``, where ``start`` is.

        ``watched`` : whether stability is looked at wherever a contact changes, with a factorisation each; needed only
        where the equilibrium at the target turns out to be unstable.
        """
        del self.record.events[self.begun :]
        self.passed: dict[float, FloatArray] = {}
        self.singly_until = start.load_factor
        point = self._balanced(point)
        n = self.problem.n
        returned = 0  #: times that the equilibrium at the target was unstable
        while True:
            still = 0  #: points in turn at one load
            while point.factor != self.target:
                before, system, known = point, self.system, len(self.record.events)
                point = self._advance(point, still > OPTIONS.still)
                lost = any(event.lost for event in self.record.events[known:])
                if watched and not lost:
                    point = self._first_unstable(before if self.system is system else None, point)
                still = still + 1 if abs(point.factor - before.factor) * self.unit < self.rates.force else 0
                self._look_down(point.factor, self.system.reference[:, 1] + point.known.q[n : 2 * n])
                if self.progress is not None and self.direction * (point.factor - self.reported) > 0.0:
                    self.reported = point.factor
                    self.progress(point.factor)
            state = self._state(point)
            if state.certificate.stable is not False:
                return replace(state, reached=replace(state.reached, events=tuple(self.record.events[self.begun :])))
            if not watched:
                return self._followed(self._at(start), start, watched=True)
            returned += 1
            if returned > OPTIONS.still:
                raise PathError(f"the equilibrium at load factor {self.target:g} is unstable, and motion returns to it")
            try:
                point = self._by_motion(point, "bifurcation", "unstable", None)
            except (DynamicsError, PathError):  # motion hardly leaves it, and finds nothing beside it
                point = self._at(state)
                direction = self._direction(point.trial, point.sense)
                if direction is None:
                    raise
                point = self._by_motion(point, "bifurcation", "unstable", direction)

    def _first_unstable(self, before: Point | None, point: Point) -> Point:
        """``point``, if it is stable with the statuses of its increment; else the one that motion leads to.

        That begins where stability is lost after ``before``; at ``point`` itself if candidates have been listed anew.
        """
        direction = self._direction(point.trial, point.sense)
        if direction is None:
            return point
        if before is None:
            return self._by_motion(point, "bifurcation", "unstable", direction)
        rates = self.rates.solve(before.trial, before.due) if self.together is None else None
        stable, length, last = 0.0, abs(point.factor - before.factor), before
        while (length - stable) * self.unit > OPTIONS.stability:
            middle = 0.5 * (stable + length)
            factor = before.factor + self.direction * middle
            if rates is not None:
                found = self._smooth(before, rates, middle, None)
                trial = None if found is None else found[1]
            else:
                trial = self._increased(before, factor)
            if trial is None:
                break
            sense = trial.sense if rates is None else rates.sense
            turned = self._direction(trial, sense)
            if turned is None:
                stable, last = middle, Point(factor, trial, sense, sense)
            else:
                length, direction = middle, turned
        return self._by_motion(last, "bifurcation", "unstable", direction)

    def _direction(self, trial: Trial, sense: np.ndarray, near: Eigenpair | None = None) -> FloatArray | None:
        """(dof,) direction in which an equilibrium diverges with signed statuses ``sense``; None if none is found.

        ``near`` : a negative eigenvalue of the point before, if it may still be there.
        """
        fixed = self.system.trial(trial.configuration, trial.configuration.q, fixed=sense)
        spectrum = Spectrum(self.system, fixed, near)
        self.unstable = spectrum.negative
        with suppress(Clustered):
            return divergence(spectrum)
        return None

    def _count(self) -> None:
        """Add the factorisations of tangents with kept statuses to what the path has cost."""
        self.record.work.factorisations += self.system.renewals
        self.system.renewals = 0

    def _at(self, state: State) -> Point:
        """A point of a new system around the positions and candidates of a state."""
        self.system = StaticSystem(self.problem, state)
        trial = self.system.at(state)
        force = max(OPTIONS.event, 10.0 * attainable(self.system, trial.configuration.q))
        self.rates = RateProblem(self.system, self.direction, force=force, negligible=OPTIONS.negligible)
        self.velocity: FloatArray | None = None
        turned, moved = state.angle - self.start.angle, state.position - self.start.position
        self.origin = np.concatenate([moved.T.ravel(), turned])[: self.system.dof]
        self.suspect = 0  #: negative pivots at the last point
        self.steps = 0  #: of the last landing
        self.unstable = None
        return Point(state.load_factor, trial, trial.sense, trial.sense)

    def _balanced(self, point: Point) -> Point:
        """A start that dynamics alone has left nearly at rest: the equilibrium beside it."""
        external = external_force(self.problem, point.factor)
        if float(np.abs(point.trial.contact_force + external).max(initial=0.0)) < 10.0 * self.rates.force:
            return point
        found = solve_increment(self.system, point.known, external, point.known.q, self.record.work)
        if found is None:
            raise PathError(
                f"no equilibrium beside the start at load factor {point.factor:g}: it is not at rest; "
                "take a smaller protocol.stop_kinetic_energy, or protocol.static_finish: true"
            )
        return Point(point.factor, found, found.sense, found.sense)

    def _advance(self, point: Point, stuck: bool) -> Point:
        """The next point: where a contact changes, the target, or beyond an equilibrium that is lost.

        ``stuck`` : whether contacts have changed again and again at one load.
        """
        if self.together is not None and self.direction * (point.factor - self.singly_until) >= 0.0:
            ahead = [factor for factor in self.guide if self.direction * (factor - point.factor) > 0.0]
            new = ahead[:2][-1] if ahead else self._towards(point.factor, self.together / self.unit)
            found = self._increased(point, new)
            if found is not None:
                self.passed[new] = self.origin + found.configuration.q
                self.velocity = (found.configuration.q - point.known.q) / abs(new - point.factor)
                self._record(replace(point, factor=new), found.sense)
                return self._relisted(Point(new, found, found.sense, found.sense))
            self.singly_until = new
        rates = None if stuck else self.rates.solve(point.trial, point.due)
        if rates is None:
            return self._relisted(self._lost(point, "no statuses of the contacts go on"))
        self._record(point, rates.sense)
        self.velocity = rates.velocity
        negative, before = rates.factor.negative_pivots, self.suspect
        self.suspect = negative
        # one real eigenvalue is negative, or real ones have passed zero; where contacts slide these may not go along
        if negative % 2 or negative not in (0, before):
            direction = self._direction(point.trial, rates.sense, self.unstable if negative == before else None)
            if direction is not None:
                return self._by_motion(point, "bifurcation", "unstable", direction)
        landed = self._landed(point, rates)
        return self._relisted(self._lost(point, "no equilibrium with these statuses") if landed is None else landed)

    def _look_down(self, load: float, heights: FloatArray) -> None:
        """Raise where the first loaded disk has sunk too far, of disks at ``heights`` (n,)."""
        if self.lowest > -np.inf and (height := float(heights[self.problem.load_disk[0]])) < self.lowest:
            raise Collapsed(load, height)

    def _towards(self, factor: float, step: float) -> float:
        """A load factor one ``step`` on, or the target where that is no more than a tenth of a step away."""
        return factor + self.direction * step if abs(self.target - factor) > 1.1 * step else self.target

    def _landed(self, point: Point, rates: Rates) -> Point | None:
        """Where the next contact changes, or the target or the end of the longest increment if that comes first."""
        changes, fastest = rates.changes, largest(rates.velocity[: 2 * self.problem.n])
        left = abs(self.target - point.factor)
        if fastest * left > OPTIONS.listed_again:
            left = OPTIONS.listed_again / fastest
        contact, length = changes.first()
        what = int(changes.what[contact]) if np.isfinite(length) else events.NOTHING
        passed_at = np.inf  #: length of an increment within which a contact is known to change
        for _ in range(OPTIONS.landings):
            event = (contact, what) if length < left else None
            found = self._smooth(point, rates, min(length, left), event)
            if found is None:
                left = 0.5 * min(length, left)
                if left * self.unit < OPTIONS.beyond:
                    return None
                continue
            factor, trial = found
            ahead = self.direction * (factor - point.factor)
            if event is not None and ahead * self.unit < -self.rates.force:
                left, length = 0.5 * min(length, left), np.inf  # another branch: the load would go back
                continue
            if event is not None and ahead > left:
                # the contact changes later than its rate said; or this is another branch, if it changes before
                left, length = (0.5 * left if left == passed_at else left), np.inf
                continue
            # whether rates are found at the end too: those of the start may be off by what contacts have turned since
            again = self.varying or trial.contradiction > self.rates.force
            velocity = self._velocity(trial, rates.sense) if again else rates.velocity
            if event is not None and float(velocity @ rates.velocity) < 0.0:
                left, length = 0.5 * min(length, left), np.inf  # another branch, beyond a limit point of the load
                continue
            then = self.rates.changes(trial, velocity, rates.sense)
            passed = np.flatnonzero((then.rate > 0.0) & (then.left < -self.rates.force))
            if len(passed):  # another contact came first
                back = -then.left[passed] / then.rate[passed]
                contact = int(passed[np.argmax(back)])
                left = passed_at = abs(factor - point.factor)
                what, length = int(then.what[contact]), max(left - float(back.max()), 0.0)
                if event is not None and contact == event[0]:  # Newton's method has let it go
                    left, length = 0.5 * left, np.inf
                continue
            turn = self._turn(point, rates, then, abs(factor - point.factor)) if again else None
            if turn is not None:
                left, length = turn, np.inf
                continue
            bent = self.stiffest * trial.bend
            if bent > OPTIONS.bent:
                part = min(0.5, 0.8 * (OPTIONS.bent / bent) ** (1 / 3))
                left, length = part * abs(factor - point.factor), np.inf
                continue
            self.record.work.increments += 1
            if self.steps > OPTIONS.outdated:
                self.system.outdate(rates.factor)
            if abs(factor - point.factor) * self.unit > self.rates.force:
                self.jump, self.beyond = OPTIONS.jump / self.unit, OPTIONS.beyond / self.unit
            due = then.due(self.rates.force)
            if not again:  # what the rates of the start say of contacts that bear nothing is the turn on the way
                due = due[(changes.rate[due] > 0.0) | (due == contact)]
            return Point(factor, trial, rates.sense, self.system.coupled(changed(rates.sense, due, then.what)))
        return None

    def _velocity(self, trial: Trial, sense: np.ndarray) -> FloatArray:
        """(dof,) rates at a trial with signed statuses ``sense``; zero where the tangent is singular."""
        renewed = self._renewed(trial, sense)
        return np.zeros(self.system.dof) if renewed is None else renewed[1]

    def _renewed(self, trial: Trial, sense: np.ndarray) -> tuple[Updated, FloatArray] | None:
        """Factorisation of the tangent at a trial and the (dof,) rates by it; None where it is exactly singular."""
        try:
            factor = self.system.renewed_factor(trial.configuration, sense)
            return factor, self.rates.velocity(trial.configuration, sense, factor)
        except RuntimeError:
            return None

    def _turn(self, point: Point, rates: Rates, then: Changes, length: float) -> float | None:
        """Where the first slip has turned round within an increment of a ``length``, by less than a force; or None."""
        back = np.flatnonzero((then.what == events.STICKS) & (then.rate > 0.0))
        way = np.where(rates.sense[back] > 0, events.SLIDES, -events.SLIDES)
        falls = zip(back.tolist(), way.tolist(), strict=True)
        ahead = np.array([max(self.rates.until(point.trial, c, w, rates.velocity)[1], 0.0) for c, w in falls])
        turns = length * ahead / (ahead + then.rate[back])  # were the rate of slip linear
        late = 0.5 * then.rate[back] * (length - turns) > self.rates.force
        for k in np.flatnonzero(late)[np.argsort(turns[late], kind="stable")]:
            c, w = int(back[k]), int(way[k])

            @cache  # the ends are asked for twice
            def slip(part: float, c: int = c, w: int = w) -> float:
                found = (point.factor, point.trial) if part == 0.0 else self._smooth(point, rates, part, None)
                if found is None:
                    return -1.0
                trial = found[1]
                return self.rates.until(trial, c, w, self._velocity(trial, rates.sense))[1]

            # slip beyond its turn grows as the square of the length
            beyond = float(np.sqrt(self.rates.force * length / (ahead[k] + then.rate[c])))
            if slip(0.0) > 0.0 and slip(length) >= 0.0:
                return 0.5 * length  # the event that was found lies on another branch, beyond a limit point
            from scipy.optimize import brentq  # a tenth of a second at the start of every process, and rare

            turn = float(brentq(slip, 0.0, length, xtol=0.25 * beyond)) if slip(0.0) > 0.0 else 0.0
            if length > turn + 1.5 * beyond:
                return turn + beyond
        return None

    def _smooth(
        self, point: Point, rates: Rates, length: float, event: tuple[int, int] | None
    ) -> tuple[float, Trial] | None:
        """Load factor and equilibrium with the statuses of ``rates`` a ``length`` of the load factor on.

        With an ``event``, a contact and what it does, the load factor is an unknown too: that at which the contact does
        it. Newton's method by the tangent at ``point``, or by that of an iterate where it does not lead there soon.
        """
        known = point.known
        at_end = event is None and length >= abs(self.target - point.factor)
        factor = self.target if at_end else point.factor + self.direction * length
        by, velocity, system = rates.factor, rates.velocity, self.system
        q = system.displaced(known.q + abs(factor - point.factor) * velocity, factor)
        before, enough, stalled = np.inf, NEWTON.enough if event is None else OPTIONS.passing, False
        self.steps = 0
        for done in range(OPTIONS.newton):
            along = abs(factor - point.factor)
            trial = system.trial(known, q, fixed=rates.sense, velocity=rates.velocity, length=along)
            force = trial.contact_force + external_force(self.problem, factor)
            size = largest(force)
            left, rate = (0.0, 0.0) if event is None else self.rates.until(trial, *event, velocity)
            if not np.isfinite(size):
                return None
            rounding = size > 0.5 * before and size <= attainable(system, q)
            # a contact that began to slide a little early leaves a torque on a disk of which all contacts slide
            left_over = stalled and size > OPTIONS.slow * before and size <= self.rates.force
            balanced = size <= enough or rounding or left_over
            if balanced and abs(left) <= 0.5 * self.rates.force:
                return factor, trial
            stalled = size > OPTIONS.slow * before
            if stalled or done % OPTIONS.same_tangent == OPTIONS.same_tangent - 1:
                renewed = self._renewed(trial, rates.sense)
                if renewed is None:
                    return None
                by, velocity = renewed
                velocity[rates.idle] = rates.velocity[rates.idle]
                if event is not None:
                    _, rate = self.rates.until(trial, *event, velocity)
            before = size
            self.steps += 1
            step = system.deinterleave(by.solve(system.interleave(force)))
            step[rates.idle] = 0.0  # it would be the rounding of a torque over next to no stiffness
            longest = largest(step[: 2 * self.problem.n])
            if longest > NEWTON.longest_step:  # a contact of the 3/2 law that has just closed has no stiffness yet
                step *= NEWTON.longest_step / longest
            if event is not None and rate <= 0.0:  # it does not come nearer: on with new rates from here
                event = None
            elif event is not None:
                further = (left - self.rates.until(trial, *event, step)[1]) / rate
                factor += self.direction * further
                step += further * velocity
            q = system.displaced(q + step, factor)
        return None

    def _relisted(self, point: Point) -> Point:
        """Where disks have moved so far that others may be near: candidates listed anew."""
        moved = largest(point.known.q[: 2 * self.problem.n])
        if moved <= OPTIONS.listed_again and point.factor != self.target:
            return point
        if self.system.meets_unlisted(point.known.q):
            return self._by_motion(point, "jump", "disks meet that were not neighbours", None)
        if moved <= OPTIONS.listed_again:
            return point
        self._count()
        keys = self.system.status_keys()
        new = self._at(self.problem.relisted(self.system.state(point.trial, point.factor)))
        sense, due = (carried(keys, self.system.status_keys(), status) for status in (point.sense, point.due))
        trial = self.system.trial(new.known, new.known.q, fixed=sense)
        return Point(point.factor, trial, sense, due)

    def _lost(self, point: Point, reason: str) -> Point:
        """The equilibrium under a load that is a little larger, if it is near; else the one that motion leads to.

        Motion alone would shake contacts off their limit where slow loading passes: in a slab of 32 disks at friction 1
        it leaves twice the distance from slow dynamics.
        """
        new = self._towards(point.factor, self.beyond)
        found = self._increased(point, new)
        if found is not None:
            n = self.problem.n
            before, after = (one.q[: 2 * n].reshape(2, n).T for one in (point.known, found.configuration))
            moved = after - before
            if np.abs(moved).max(initial=0.0) <= OPTIONS.nearby:
                position = self.system.reference + before
                self.record.events.append(lost("stepped over", point.factor, new, position, moved, reason))
                self._record(point, found.sense, until=new)
                self.beyond *= 2.0
                return Point(new, found, found.sense, found.sense)
        return self._by_motion(point, "jump", reason, None)

    def _by_motion(self, point: Point, kind: str, reason: str, direction: FloatArray | None) -> Point:
        """The equilibrium that the disks move to from a lost one, displaced a little along ``direction``.

        The load goes on growing as fast as the protocol says.
        """
        self._count()
        _, here = self._uncertified(point)
        start = here if direction is None else nudged(self.problem, here, direction)
        new = self._towards(point.factor, self.jump)
        found: list[Point] = []

        def accept(state: State) -> bool:
            found[:] = [self._at(state)]
            return state.certificate.stable is True or not diverging(Spectrum(self.system, found[0].trial))

        protocol = self.problem.scene.protocol
        try:
            settled = settle(
                self.problem, start, CROSSING, Stop(CROSSING_STOP, maximum_steps=protocol.maximum_steps),
                what=f"load factor {new:g}", accept=accept,
                load=(point.factor, new, protocol.ramp_time * abs(new - point.factor)),
                progress=lambda dynamics, _: self._look_down(new, dynamics.position[:, 1]),
            )  # fmt: skip
        except NotSettled as error:
            raise PathError(f"no equilibrium beyond load factor {point.factor:g}: {error}") from error
        self.record.events.append(
            lost(kind, point.factor, new, here.position, settled.position - here.position, reason)
        )
        self.jump *= 2.0
        return replace(found[0], factor=new)

    def _increased(self, point: Point, new: float) -> Trial | None:
        """Equilibrium with the return map, one increment on, whatever changes within it."""
        external = external_force(self.problem, new)
        guess = point.known.q if self.velocity is None else point.known.q + abs(new - point.factor) * self.velocity
        guesses = [guess, self.guide[new] - self.origin] if new in self.guide else [guess]
        guesses = [self.system.displaced(one, new) for one in guesses]
        if len(guesses) > 1:  # a short increment is nearer by its rates, a long one by what was found before
            guesses.sort(key=lambda q: np.abs(self.system.trial(point.known, q).contact_force + external).max())
        return solve_increment(self.system, point.known, external, guesses[0], self.record.work)

    def _uncertified(self, point: Point) -> tuple[Trial, State]:
        """A point with the statuses that its contacts have at rest, and the state of that."""
        # what is within rounding of opening or closing is as its overlap says
        overlap = point.trial.configuration.overlap
        along = point.trial.sense[: len(overlap)]
        along = np.where(overlap <= 0.0, OPEN, np.where(along == OPEN, STICKING, along))
        sense = self.system.coupled(np.concatenate([along, point.trial.sense[len(overlap) :]]))
        trial = self.system.trial(point.known, point.known.q, fixed=sense)
        return trial, self.system.state(trial, point.factor)

    def _state(self, point: Point) -> State:
        """The certified state of a point."""
        trial, state = self._uncertified(point)
        modes = diverging(Spectrum(self.system, trial))
        self._count()
        work, certificate = self.record.work, certify(self.problem, state, modes=modes)
        reached = Reached("path", certificate, increments=work.increments, factorisations=work.factorisations)
        return replace(state, reached=reached)

    def _record(self, point: Point, after: np.ndarray, until: float | None = None) -> None:
        """The events in which contacts get the signed statuses ``after`` (m + w,), at the latest ``until``."""
        system, n, m = self.system, self.problem.n, len(self.system.first)
        count = m + len(system.wall_disk)
        moved = point.known.q[: 2 * n].reshape(2, n).T
        for c in np.flatnonzero(point.sense != after).tolist():
            kinds = _kinds(before := int(point.sense[c]), now := int(after[c]))
            if c >= count:
                if OPEN in (before, now):  # a contact that opens or closes does so along the rolling too
                    continue
                kinds = tuple(map(ROLLING.__getitem__, kinds))
            c, at_wall = c % count, c % count >= m
            i, j = (system.wall_disk, system.wall) if at_wall else (system.first, system.second)
            first, second = int(i[c - m * at_wall]), int(j[c - m * at_wall])
            here = system.reference[first] + moved[first]
            if at_wall:
                towards = -system.wall_normals[c - m]
            else:
                towards = self.problem.packing.box.separation(system.reference[second] + moved[second], here)
            x, z = here + towards * (self.problem.packing.radius[first] / np.hypot(*towards))
            until_then = point.factor if until is None else until
            self.record.events += [
                Event(point.factor, kind, first, second, at_wall, float(x), float(z), until_then) for kind in kinds
            ]


def largest(values: FloatArray) -> float:
    """The largest size among numbers (k,); not a number where one of them is none."""
    return max(float(values.max()), -float(values.min()))


def lost(kind: str, factor: float, until: float, position: FloatArray, moved: FloatArray, reason: str) -> Event:
    """The loss of an equilibrium, after which disks at ``position`` (n, 2) have moved by ``moved`` (n, 2)."""
    far = np.hypot(*moved.T)
    i = int(np.argmax(far))
    x, z = position[i]
    return Event(factor, kind, i, x=float(x), z=float(z), until=until, displacement=float(far[i]), reason=reason)


def carried(before: NDArray[np.int64], after: NDArray[np.int64], sense: np.ndarray) -> np.ndarray:
    """Signed statuses of the candidates ``before`` in the order of those ``after``; open where one is new."""
    known = dict(zip(before.tolist(), sense.tolist(), strict=True))
    return np.array([known.get(key, OPEN) for key in after.tolist()], sense.dtype)


def _kinds(before: int, after: int) -> tuple[str, ...]:
    """What a contact does between two signed statuses."""
    if after == OPEN:
        return ("opens",)
    if before == OPEN:
        return ("closes", "slides") if abs(after) == SLIDING else ("closes",)
    if after == STICKING:
        return ("sticks",)
    return ("reverses",) if abs(before) == SLIDING else ("slides",)
