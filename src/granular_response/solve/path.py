"""Quasi-static loading: a sequence of equilibria under a growing or falling load (the limit of infinitely slow ramps).

Each increment is solved with the return map of ``kernels.statics`` (see :mod:`.increment`). Where a contact goes on
opening, sliding or sticking throughout an increment the return map is exact for any length of the increment. With a
tolerance, increments grow as long as their errors (see :mod:`.increment_error`) stay within it.
Where no equilibrium is found on the shortest increment, or the equilibrium has lost its stability, the branch has
ended: explicit dynamics carries the packing to the next equilibrium and statics goes on from there. So it does where
an increment, or a stretch of load, has cost more factorisations than the limits below. With a loose tolerance it takes
all that is left of the way where that costs less than increments like the last ones: the error of a linear ramp falls
as one over its duration, so the tolerance says how long it must be. Every such crossing is recorded with its load and
its reason.

Stability is looked at about once per mean disk weight of load; with a tolerance less often, and only if any contact
has changed since. With sliding contacts a negative eigenvalue of the tangent is only a suspicion (the tangent belongs
to one direction of sliding), so it is tried: dynamics starts from the state displaced a little along the suspicious
direction, and either comes back or leaves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..errors import SolveError
from ..state import Crossing, FloatArray, Reached, State
from .dynamics import Dynamics, DynamicsError, Stop, relax
from .equilibrium import certify, external_force
from .increment import HASTY, PATIENT, Work, solve_increment
from .increment_error import Place, error_of_two
from .problem import Problem
from .settle import CROSSING as CROSSING_OVER
from .settle import CROSSING_STOP, STAGE, STAGE_STOP, HandOver, NotSettled, nudged, settle
from .system import Configuration, StaticSystem, Trial
from .timestep import stability_limit

#: First load increment in mean disk weights, or as a part of a load below that, times the square root of the number of
#: disks: the deeper a packing, the more load it takes to change as many contacts. But under the load they change at the
#: same one however deep it is.
FIRST_STEP, LONGEST_FIRST = 0.0033, 1.6
#: First increment of a large load, as a part of it.
LARGE_LOAD = 0.005
#: Longest increment as a part of the first for the tolerance, and shortest as a part of the first for none.
LONGEST, SHORTEST = 5.0, 0.25
#: Tolerance for which first increments are short enough without a look at their error, if they are such a part of the
#: load between two states that are kept: where that is less, one contact makes more of it.
TRUSTED_FOR, TRUSTED_PART = 1e-5, 0.006
#: Factorisations that an easy increment takes at most.
EASY = 3
#: By which an increment is longer than easy ones before, and shorter than one that needed fixed limits; and so many
#: increments in turn must need none before one is longer than the first.
GROWTH, SHRINK, CALM = 1.4, 0.9, 5
#: Load that dynamics crosses at first, in mean disk weights; doubled while statics does not go on after it.
CROSSING = 0.1
#: Load between two looks at the stability, without a tolerance and with that of first increments; with a looser one it
#: is longer in proportion, up to the last.
STABILITY_STEP, WITH_TOLERANCE, FARTHEST = 1.0, 3.0, 10.0
#: Factorisations that statics may spend on ``STABILITY_STEP`` of load; after that dynamics is the cheaper way.
MOST_WORK = 1000
#: Ramp by which dynamics takes all that is left of the way within a tolerance: this many crossing times of a
#: compression wave, over the tolerance, for the whole way; and at least so many (docs/physics.md has the errors).
RAMP, SHORTEST_RAMP = 0.3, 4.0
#: Dashpots of that ramp over critical ones, if the scene has more; its disks move like rings. In the limit that it
#: approaches neither matters, and the step is four times as long.
RAMP_DAMPING = 0.125
#: Time steps that cost as much as a factorisation with all that an increment does beside it, for slabs of any size.
STEPS_AS_DEAR = 100
#: Tightest tolerance for that: a ramp may leave a symmetric branch for another one, some hundredths of the load away.
LOOSE = 1e-3
#: Fewest disks for that: in smaller packings increments cost next to nothing, and single disks swing more slowly than a
#: wave crosses.
MANY = 200
#: Times its ramp in which it must settle.
SETTLES_WITHIN = 10.0
#: Part of what dynamics would cost that statics has to show what it costs itself.
SAMPLE = 0.1
#: Weight of earlier increments, from one to the next, in what the last ones have cost.
FADING = 0.8
#: Unbalanced force (mean disk weights), beside so many units of rounding of an overlap, up to which a start is at rest.
BALANCED, ROUNDING = 1e-8, 16.0
#: Displacement after which candidate contacts are listed again (mean radii), below half of the largest gap listed.
LISTED_AGAIN = 0.25
#: Displacement after which an equilibrium that was displaced a little counts as left.
LEFT = 2e-5
#: Least time of such a trial, in sqrt(R/g): it starts at rest, so that nothing moves at first on any slope.
TRIAL_TIME = 20.0
#: Its integrator and part of the longest stable step: nothing is asked but whether the packing leaves; and those of
#: dynamics that takes the rest of the way.
TRIAL_INTEGRATOR, TRIAL_STEP = "leapfrog", 0.9


class PathError(SolveError, RuntimeError):
    """The load path could not be continued."""


@dataclass
class PathRecord:
    """What happened on a load path."""

    work: Work = field(default_factory=Work)
    crossings: list[Crossing] = field(default_factory=list)
    stability_checks: int = 0
    stability_trials: int = 0
    comparisons: int = 0  #: of two increments with a single one


def follow(
    problem: Problem,
    rest: State,
    factors: Sequence[float],
    *,
    integrator: str = "beeman",
    time_step: float | None = None,
    longest_step: float | None = None,
    tolerance: float | None = None,
    crossing_ramp: float = 20.0,
    maximum_steps: int = 2_000_000,
    progress: Callable[[float], None] | None = None,
    record: PathRecord | None = None,
) -> list[State]:
    """States at the load ``factors`` in turn, growing or falling, reached through every load between.

    Parameters
    ----------
    problem : with its loads chosen.
    rest : certified state at load factor ``rest.load_factor``; a path may start from any of the states it returned,
        also from a file, and then goes on to the last bit as if it had not been cut.
    factors : multipliers of the loads, in turn.
    time_step : where dynamics takes over, in sqrt(R/g); that of the protocol if not given, looked at only when needed.
    longest_step : bound on an increment, in mean disk weights, in place of increments by their error.
    tolerance : error of a floor or wall force that increments may leave, per load; that of the protocol if not given.
        Increments are short throughout where neither says one.
    crossing_ramp : duration of the load ramp where dynamics takes over, in sqrt(R/g).
    maximum_steps : most time steps in which dynamics must come to rest there.

    Raises
    ------
    PathError
        When dynamics does not settle either: the packing collapses or cycles under this load.
    """
    dynamics = _DynamicsOptions(integrator, time_step, crossing_ramp, maximum_steps)
    if tolerance is None:
        tolerance = problem.scene.protocol.path_tolerance
    return _Path(problem, rest, factors, dynamics, longest_step, tolerance, progress, record).states()


@dataclass(frozen=True)
class _DynamicsOptions:
    """How dynamics goes where it takes over."""

    integrator: str
    time_step: float | None
    ramp: float
    maximum_steps: int
    over: HandOver = CROSSING_OVER
    energy: float = CROSSING_STOP  #: kinetic energy per disk at which statics is tried first


def _towards(here: float, target: float, step: float) -> float:
    """A load factor one ``step`` nearer to ``target``, or the target."""
    return min(here + step, target) if target > here else max(here - step, target)


class _Path:
    """The present end of a load path."""

    def __init__(self, problem, rest, factors, dynamics: _DynamicsOptions, longest_step, tolerance, progress, record):
        self.problem: Problem = problem
        self.record: PathRecord = PathRecord() if record is None else record
        self.progress = progress
        self.dynamics = dynamics
        self.unit = problem.load_size
        self.factors: Sequence[float] = factors
        self.longest_step = longest_step
        #: None where increments keep to the first length
        self.tolerance: float | None = tolerance if longest_step is None else None
        self.stretch = 1.0 if self.tolerance is None else LONGEST
        #: whether errors are looked at: without friction increments of any length are exact
        self.looks = self.tolerance is not None and problem.rotations
        self.looseness = tolerance / TRUSTED_FOR if self.looks else np.inf
        self.loose = self.looks and tolerance >= LOOSE
        loose = 1.0 if self.tolerance is None else max(self.tolerance / TRUSTED_FOR, 1.0)
        #: by which increments are longer than for the tolerance of first ones: their errors grow faster than they do
        self.coarser = loose**0.5
        #: load factor between two looks at the stability
        apart = STABILITY_STEP if self.tolerance is None else min(WITH_TOLERANCE * loose, FARTHEST)
        self.apart = apart / self.unit
        self.factor = rest.load_factor
        self.start_is_stable = rest.reached.certificate is not None and rest.reached.certificate.stable is True
        self.middle: Place | None = None
        #: a state ahead that is known, but was too far away for the tolerance
        self.beyond: Place | None = None
        self._restart(rest, factors[0] if len(factors) else rest.load_factor)

    def _restart(self, state: State, target: float) -> None:
        """Go on to ``target`` from a state that is kept as from one read from a file: nothing else is remembered.

        So a path may be cut at any of its states and taken up again without a change to the last bit.
        """
        #: load factors of the last state that was kept and of the next one, and error of wall forces since
        self.kept_at, self.target, self.spent = self.factor, target, 0.0
        self.step = self.usual
        #: increments in turn that Newton's method alone has found
        self.calm = CALM
        self.crossing = CROSSING / self.unit
        #: load and work at which the work limit begins to count
        self.mark = (self.factor, self.record.work.factorisations)
        #: load factor that the last increments have gained and factorisations that they took, and work before them
        self.gained, self.cost, self.begun = 0.0, 0.0, self.record.work.factorisations
        #: whether dynamics may take the rest of the way, tried once; how long a ramp must be was measured for forces
        self.may_leave = self.loose and self.problem.n >= MANY and not len(self.problem.held)
        self._begin(state)

    def _begin(self, state: State) -> None:
        """Go on from a state, with nothing known of how displacements grow with the load."""
        self.system = StaticSystem(self.problem, state, updated=self.tolerance is not None)
        self.known: Configuration = self.system.start(state)
        self.trial: Trial = self.system.trial(self.known, self.known.q)
        self.rate: FloatArray | None = None
        self.modes = 0
        self._begin_pair()
        #: the last state whose stability was looked at
        self.stable_at = self.factor
        self.stable_known, self.stable_trial = self.known, self.trial

    def states(self) -> list[State]:
        self._balance()
        results: list[State] = []
        for target in self.factors:
            if results:
                self._restart(results[-1], target)
            elif target == self.factor and not self.start_is_stable:
                self._look_at_stability()
            left = abs(target - self.factor)
            while self.factor != target:
                self._advance(target)
                if self.progress is not None and abs(target - self.factor) < left:  # not where it went back
                    left = abs(target - self.factor)
                    self.progress(self.factor)
            results.append(self._state())
        return results

    def _balance(self) -> None:
        """A start that dynamics alone has left nearly at rest: go to the equilibrium beside it."""
        external = external_force(self.problem, self.factor)
        rounding = ROUNDING * float(np.finfo(float).eps) * self.problem.stiffness
        if float(np.abs(self.trial.contact_force + external).max(initial=0.0)) < BALANCED + rounding:
            return
        found = solve_increment(self.system, self.known, external, self.known.q, self.record.work)
        if found is None:
            raise PathError(
                f"no equilibrium beside the start at load factor {self.factor:g}: it is not at rest; "
                "take a smaller protocol.stop_kinetic_energy, or protocol.static_finish: true"
            )
        self.known, self.trial = found.configuration, found
        self.stable_known, self.stable_trial = self.known, self.trial
        self._begin_pair()
        self._look_at_stability()

    def _advance(self, target: float) -> None:
        """One increment towards ``target``, by statics or across the end of a branch by dynamics."""
        if self._worked_too_much():
            self._cross(_towards(self.mark[0], target, STABILITY_STEP / self.unit), "too much work")
            return
        if self.may_leave and self._dynamics_is_cheaper(target):
            self._leave_to_dynamics(target)
            return
        left, before, crossings = abs(target - self.factor), self.record.work.factorisations, len(self.record.crossings)
        self._increase(target)
        # less than nothing where it went back
        gained = left - abs(target - self.factor) if len(self.record.crossings) == crossings else 0.0
        fading = FADING if gained > 0.0 else 1.0
        self.gained = fading * self.gained + gained
        self.cost = fading * self.cost + self.record.work.factorisations - before

    def _increase(self, target: float) -> None:
        """One increment towards ``target`` by statics, and what its outcome asks for."""
        new = self._next(target)
        increment = abs(new - self.factor)
        work = self.record.work
        rounds, factorisations = work.rounds, work.factorisations
        shorter = increment > 1.2 * self.shortest  # the last one before a target is up to 1.1 steps long
        # rounds with fixed limits may take so many that dynamics would cost less
        leaves = shorter and self.may_leave and self._dynamics_cost(target) < HASTY.factorisations
        found = solve_increment(
            self.system, self.known, external_force(self.problem, new), self._guess(new), work,
            passing=new != target and self.tolerance is not None,
            stubborn=self.tolerance is None or (increment < 1.2 * self.usual and not leaves),
            patience=HASTY if shorter else PATIENT,
        )  # fmt: skip
        if found is None:
            if shorter:
                self.step = min(max(0.5 * increment, self.shortest), self.usual)
                self.rate = None
                self.calm = 0
            else:
                self._cross(_towards(self.factor, target, self.crossing), "no equilibrium")
                self.crossing *= 2.0
            return
        self.crossing = max(0.5 * self.crossing, CROSSING / self.unit)
        self.rate = (found.configuration.q - self.known.q) / (new - self.factor)
        self.factor, self.known, self.trial = new, found.configuration, found
        before = self.start if self.middle is None else self.middle
        here = Place(new, found.configuration, found, before if self.looks else None)
        if work.rounds > rounds:
            self.growth, self.calm = SHRINK, 0
        elif self.tolerance is not None and work.factorisations - factorisations > EASY:
            self.growth = min(self.growth, 1.0)
        if self.middle is not None:
            if not self._keeps_tolerance(here, target):
                return
        elif new != target and increment > 1.2 * self.trusted:
            self.middle = here
            return
        self._go_on(here)
        if new == target and self.system.meets_unlisted(self.known.q):
            self.factor, self.known, self.trial = self.stable_at, self.stable_known, self.stable_trial
            self._cross(target, "rearrangement")
            return
        far = new != target and np.abs(self.known.q[: 2 * self.problem.n]).max() > LISTED_AGAIN
        if new == target or far or self._may_have_become_unstable():
            self._look_at_stability()
        if far and self.factor == new:
            self._list_again(target)

    def _list_again(self, target: float) -> None:
        """Disks have moved so far that others may be near: list candidates anew, and go on from there."""
        if self.system.meets_unlisted(self.known.q):
            self._cross(_towards(self.factor, target, self.crossing), "rearrangement")
            return
        self._begin(self.problem.relisted(self.system.state(self.trial, self.factor)))

    def _next(self, target: float) -> float:
        """Load factor at the end of the next increment; an increment whose error must be known is not the last one."""
        left = abs(target - self.factor)
        if self.middle is None and self.trusted < self.step and 1.1 * self.trusted < left < 2.1 * self.step:
            self.step = 0.5 * left
        new = _towards(self.factor, target, self.step)
        return target if abs(target - new) < 0.1 * self.step else new

    def _guess(self, new: float) -> FloatArray:
        """(dof,) displacements expected at load factor ``new``."""
        if self.beyond is not None and self.beyond.factor == new:
            return self.beyond.known.q
        guess = self.known.q if self.rate is None else self.known.q + (new - self.factor) * self.rate
        return self.system.displaced(guess, new)

    def _keeps_tolerance(self, end: Place, target: float) -> bool:
        """Whether the last two increments, up to ``end``, are as good as they must be; if not, back to their beginning.

        Errors of all increments between two states that are kept add up to less than the tolerance times the load
        between them; where one takes much of that, the next ones are no longer.
        """
        start, middle = self.start, self.middle
        assert middle is not None and self.tolerance is not None
        error = error_of_two(self.system, start, middle, end, self.record.work)
        self.record.comparisons += 1
        share = self.tolerance * self.unit * abs(end.factor - start.factor)
        first = abs(middle.factor - start.factor)
        left = self.tolerance * self.unit * abs(target - self.kept_at) - self.spent
        if error > left and first > 1.2 * self.trusted:
            self.factor, self.known, self.trial = start.factor, start.known, start.trial
            self.beyond, self.middle, self.growth = middle, None, 1.0
            self.rate = (middle.known.q - start.known.q) / (middle.factor - start.factor)
            self.step = max(0.5 * first, self.trusted)
            return False
        self.spent += min(error, max(left, 0.0))
        if error > share:
            self.growth = min(self.growth, 1.0)
        return True

    def _go_on(self, here: Place) -> None:
        """Go on from here, the end of an increment."""
        self.calm += 1
        self.step = min(self.step * self.growth, self.usual * (self.stretch if self.calm > CALM else 1.0))
        if here.before is not None:
            here.before.before = None  # no longer asked for
        self._begin_pair(here)

    def _begin_pair(self, here: Place | None = None) -> None:
        """The error of the next two increments is that against a single one from here."""
        self.start = Place(self.factor, self.known, self.trial) if here is None else here
        self.middle = self.beyond = None
        self.growth = GROWTH

    @property
    def least_first(self) -> float:
        """Length of a first increment on the way to the next state that is kept, under small loads."""
        if self.longest_step is not None:  # nothing is added to what the caller asks for
            return self.longest_step / self.unit
        load = self.unit * max(abs(self.kept_at), abs(self.target))
        return min(FIRST_STEP * self.problem.n**0.5, LONGEST_FIRST) * min(load, 1.0) / self.unit

    @property
    def shortest(self) -> float:
        """Length of the shortest."""
        return SHORTEST * self.least_first

    @property
    def first(self) -> float:
        """Length of a first increment here."""
        part = LARGE_LOAD if self.longest_step is None else 0.0
        return max(self.least_first, part * abs(self.factor))

    @property
    def usual(self) -> float:
        """Length of a first increment here with the tolerance."""
        return self.first * self.coarser

    @property
    def trusted(self) -> float:
        """Length of increments whose error is not looked at."""
        if not self.looks:
            return np.inf
        part = self.looseness * TRUSTED_PART * abs(self.target - self.kept_at)
        return min(self.looseness * self.first, self.usual, part)

    def _worked_too_much(self) -> bool:
        """Whether the last stretch of load has cost more than it may."""
        work = self.record.work.factorisations
        if abs(self.factor - self.mark[0]) >= STABILITY_STEP / self.unit:
            self.mark = (self.factor, work)
        return work - self.mark[1] > MOST_WORK

    @cached_property
    def ramped(self) -> Problem:
        """The packing as it moves where dynamics takes the rest of the way."""
        ratio = self.problem.scene.contact.damping_ratio
        return self.problem.moving(rings=True, dashpots=RAMP_DAMPING / max(ratio, RAMP_DAMPING))

    @cached_property
    def ramp_step(self) -> float:
        """Time step there."""
        return TRIAL_STEP * stability_limit(self.ramped, TRIAL_INTEGRATOR, smallest=True)

    def _ramp(self, target: float) -> float:
        """Duration of a ramp of dynamics to ``target`` for what is left of the tolerance, in sqrt(R/g)."""
        assert self.tolerance is not None
        left = self.tolerance * abs(target - self.kept_at) - self.spent / self.unit
        if left <= 0.0:
            return np.inf
        return max(RAMP * abs(target - self.start.factor) / left, SHORTEST_RAMP) * self.problem.crossing_time

    def _dynamics_cost(self, target: float) -> float:
        """Factorisations as dear as dynamics to ``target`` within the tolerance; infinite beyond its steps."""
        steps = (self._ramp(target) + STAGE.hold) / self.ramp_step
        return steps / STEPS_AS_DEAR if steps <= self.dynamics.maximum_steps else np.inf

    def _dynamics_is_cheaper(self, target: float) -> bool:
        """Whether what is left of the way would cost less by dynamics, by what the last increments have cost."""
        dynamics = self._dynamics_cost(target)
        if self.record.work.factorisations - self.begun < SAMPLE * dynamics:
            return False
        return self.cost * abs(target - self.factor) > dynamics * max(self.gained, self.shortest)

    def _leave_to_dynamics(self, target: float) -> None:
        """Dynamics to ``target``, from the last state of known error; where it does not settle statics goes on."""
        self.factor, self.known, self.trial = self.start.factor, self.start.known, self.start.trial
        self.may_leave = False
        here = self._state()
        ramp = self._ramp(target)
        most = min(self.dynamics.maximum_steps, round(SETTLES_WITHIN * (ramp + STAGE.hold) / self.ramp_step))
        quick = _DynamicsOptions(TRIAL_INTEGRATOR, self.ramp_step, ramp, most, STAGE, STAGE_STOP)
        try:
            self._cross(target, "too much work", quick)
        except (PathError, DynamicsError):
            self.factor = here.load_factor
            self._begin(self.problem.relisted(here))
            self._look_at_stability()

    def _may_have_become_unstable(self) -> bool:
        """Whether enough has happened since the last look; without a change of any contact the tangent is the same."""
        if abs(self.factor - self.stable_at) < self.apart:
            return False
        return self.tolerance is None or not np.array_equal(self.trial.sense, self.stable_trial.sense)

    def _look_at_stability(self) -> None:
        self.modes = self.system.negative_modes(self.trial)
        self.record.stability_checks += 1
        if self.modes and self._leaves():
            self._go_back_and_cross()
            return
        self.modes = 0
        self.stable_at, self.stable_known, self.stable_trial = self.factor, self.known, self.trial

    def _leaves(self) -> bool:
        """Whether the present equilibrium, slightly displaced, moves away for good.

        With sliding contacts the tangent is that of one direction of sliding, so a state may leave in one sense alone.
        """
        state, direction = self._state(), self.system.unstable_direction(self.trial)
        return self._leaves_towards(state, direction) or self._leaves_towards(state, -direction)

    @cached_property
    def quick_step(self) -> float:
        """Time step of dynamics of which nothing is asked but whether it leaves."""
        return TRIAL_STEP * stability_limit(self.problem, TRIAL_INTEGRATOR, smallest=True)

    def _leaves_towards(self, state: State, direction: FloatArray) -> bool:
        beside = nudged(self.problem, state, direction)
        dynamics = Dynamics(self.problem, beside, TRIAL_INTEGRATOR, self.quick_step)
        self.record.stability_trials += 1
        stop = Stop(1e-11, maximum_steps=min(200_000, self.dynamics.maximum_steps), least_time=TRIAL_TIME)
        settled = relax(dynamics, stop, load=(self.factor, self.factor, 0.0))
        return bool(np.abs(settled.position - state.position).max() > LEFT)

    def _go_back_and_cross(self) -> None:
        """The branch lost its stability since the last look: narrow down where, then cross by dynamics."""
        unstable = self.factor
        self.factor, self.known, self.trial = self.stable_at, self.stable_known, self.stable_trial
        self.rate = None
        while abs(unstable - self.factor) > CROSSING / self.unit:
            middle = 0.5 * (self.factor + unstable)
            external = external_force(self.problem, middle)
            guess = self.system.displaced(self.known.q, middle)
            found = solve_increment(self.system, self.known, external, guess, self.record.work)
            if found is None:
                break
            before = (self.factor, self.known, self.trial)
            self.factor, self.known, self.trial = middle, found.configuration, found
            if self.system.negative_modes(found) and self._leaves():
                unstable = middle
                self.factor, self.known, self.trial = before
        self._cross(unstable, "unstable")

    def _cross(self, new: float, reason: str, ramp: _DynamicsOptions | None = None) -> None:
        """Dynamics from the last equilibrium to one at load factor ``new``; ``ramp`` : over the rest of the way."""
        problem, options = (self.problem, self.dynamics) if ramp is None else (self.ramped, ramp)
        here = self._state()
        start = self.factor

        def accept(found: State) -> bool:
            self.factor = new
            self._begin(found)
            return found.certificate.stable is True or not self._leaves()

        stop = Stop(options.energy, maximum_steps=options.maximum_steps)
        try:
            settled = settle(
                problem, here, options.over, stop, what=f"load factor {new:g}", load=(start, new, options.ramp),
                accept=accept, integrator=options.integrator, time_step=options.time_step,
            )  # fmt: skip
        except NotSettled as error:
            raise PathError(f"no equilibrium beyond load factor {start:g}: {error}") from error
        moved = float(np.abs(settled.position - here.position).max())
        self.record.crossings.append(Crossing(float(start), float(new), reason, moved))
        self.mark = (new, self.record.work.factorisations)
        self.step = self.usual

    def _state(self) -> State:
        state = self.system.state(self.trial, self.factor)
        work = self.record.work
        reached = Reached(
            method="path",
            certificate=certify(self.problem, state, modes=self.modes),
            increments=work.increments,
            factorisations=work.factorisations,
            crossings=tuple(self.record.crossings),
        )
        return replace(state, reached=reached)
