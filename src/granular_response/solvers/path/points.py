"""What a load path is made of: points, the sections that these lie on, and the leg from one kept state to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import SolveError
from ...linalg import Factor
from ...linalg.lowest import Eigenpair
from ...state import OPEN, STICKING, Event, FloatArray, Reached, State
from ..dynamics import Dynamics
from ..equilibrium import attainable, certify, external_force
from ..free import least, solved_by
from ..increment import Work, solve_increment
from ..problem import Problem
from ..rates import OPTIONS as RATES
from ..rates import RateProblem
from ..stability import Spectrum, diverging
from ..system import OPTIONS as SYSTEM
from ..system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class PathOptions:
    """Numbers that a path goes by. Forces and loads in mean weights, lengths in mean radii."""

    #: Newton steps with one factorisation, and part of the residual that a step may leave; two or three are usual.
    same_tangent: int = 6
    slow: float = 0.3
    #: Newton steps of a landing above which the next rates have a factorisation of their own. Those of an old one miss
    #: events, and a landing is then tried again; a lower number asks for more factorisations than that spares.
    outdated: int = 2
    #: Load by which the next equilibrium is looked for, with limits of friction held fixed, where no statuses are found
    #: for the rates; doubled while the path does not go on after it, or it would take as many steps as a slab has loads
    #: of this size. In lattices the path mostly goes on there, only with other statuses. No shorter increment is tried.
    beyond: float = 1e-4
    #: Load to which a loss of stability between two events is found.
    found: float = 1e-6
    #: Load by which a motion off a lost equilibrium begins, which needs more to drive it; doubled likewise.
    driven: float = 1e-2
    #: Displacement up to which such an equilibrium counts as the next one; farther ones are for the motion to find.
    nearby: float = 1e-3
    #: Displacement after which candidates are listed again, and longest in one increment; the two together are below
    #: half of the largest gap listed.
    listed_again: float = 0.12
    #: Increment of a large packing that takes events together: this times the square root of the number of disks, since
    #: a deeper packing takes more load to change as many contacts.
    together: float = 0.0033


#: As measured in docs/benchmarks.md.
OPTIONS = PathOptions()


class PathError(SolveError, RuntimeError):
    """The load path could not be continued."""


class Collapsed(SolveError, RuntimeError):
    """The load has pushed its disk down farther than allowed, to ``height``."""

    def __init__(self, load: float, height: float) -> None:
        super().__init__(f"the loaded disk sinks to height {height:.3g} on the way to load {load:g}")
        self.height = height


@dataclass
class PathRecord(Work):
    """What a load path has cost, and its events so far."""

    events: list[Event] = field(default_factory=list)


@dataclass(frozen=True)
class Point:
    """An equilibrium on a path; in a section of it, where candidates are the same, points share their rate problem."""

    rate_problem: RateProblem
    factor: float
    trial: Trial
    sense: np.ndarray  #: (m + w,) signed statuses of the increment that ends here
    due: np.ndarray  #: (m + w,) those with which the rate problem begins
    velocity: FloatArray | None = None  #: (dof,) rates by which the section came here; None at its begin
    negative: int = 0  #: negative pivots of the tangent by which it did
    unstable: Eigenpair | None = None  #: the eigenvalue of the section that was found last, if it was negative

    @property
    def system(self) -> StaticSystem:
        return self.rate_problem.system

    @property
    def known(self) -> Configuration:
        return self.trial.configuration

    @property
    def moved(self) -> FloatArray:
        """(n, 2) displacements of the disks within the section."""
        n = self.system.problem.n
        return self.known.q[: 2 * n].reshape(2, n).T

    @property
    def position(self) -> FloatArray:
        """(n, 2) of the disks."""
        return self.system.reference + self.moved

    def on(self, factor: float, trial: Trial, sense: np.ndarray | None = None, due: np.ndarray | None = None) -> Point:
        """A point of the same section; with the statuses of its trial if none are given."""
        sense = trial.sense if sense is None else sense
        return replace(self, factor=factor, trial=trial, sense=sense, due=sense if due is None else due)

    def at_rest(self) -> tuple[Trial, State]:
        """The point with the statuses that its contacts have at rest, and the state of that."""
        # what is within rounding of opening or closing is as its overlap says
        overlap = self.known.overlap
        along = self.trial.sense[: len(overlap)]
        along = np.where(overlap <= 0.0, OPEN, np.where(along == OPEN, STICKING, along))
        sense = self.system.coupled(np.concatenate([along, self.trial.sense[len(overlap) :]]))
        trial = self.system.trial(self.known, self.known.q, fixed=sense)
        return trial, self.system.state(trial, self.factor)


@dataclass
class Leg:
    """The way from a state to a load factor. It changes in what it has cost, and in the two steps off lost equilibria.

    ``lowest`` : height below which the first loaded disk must not sink; ``guide`` : (dof,) displacements since the
    start at load factors where another run has been, as guesses.
    """

    problem: Problem
    record: PathRecord
    start: State
    target: float
    lowest: float
    progress: Callable[[float], None] | None
    options: PathOptions
    guide: dict[float, FloatArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.direction = 1.0 if self.target >= self.start.load_factor else -1.0
        self.begun, self.reported = len(self.record.events), self.start.load_factor
        self.unit, laws = self.problem.load_size, (self.problem.pair_law, self.problem.wall_law)
        self.whole = self.unit * abs(self.target - self.start.load_factor)
        #: Unbalanced force that is left at an event, less under a load below a mean weight. The next increment takes it
        #: up, so that it does not add up: in the slabs of the benchmarks events are off by 5e-10 in the median, and
        #: wall forces at the end by 3e-10 at most.
        self.passing = SYSTEM.bare * min(self.unit, 1.0)
        self.stiffest = max(law.tangential_stiffness for law in laws)
        #: whether the stiffness of contacts varies with their overlap
        self.varying = any(law.stiffest(2.0) != law.stiffest(1.0) for law in laws)
        #: Whether a disk whose height a load holds has been let go: residuals over rounding are no displacements then.
        #: Rattlers that gravity holds do not need it.
        known, held = self.start.reached.certificate, (self.problem.held.axis == 1).any()
        self.free = bool(held and known and known.undetermined)
        self.gone_on()

    def gone_on(self) -> None:
        """The load has grown: steps off the next lost equilibrium begin short again."""
        self.jump, self.beyond = self.options.driven / self.unit, self.options.beyond / self.unit

    def at(self, state: State) -> Point:
        """A point of a new section, around the positions and candidates of a state."""
        system = StaticSystem(self.problem, state)
        trial = system.at(state)
        force = 10.0 * attainable(system, trial.configuration.q)  # that of an event, or more where rounding is more
        rates = RateProblem(system, self.direction, force=force)
        return Point(rates, state.load_factor, trial, trial.sense, trial.sense)

    def origin(self, point: Point) -> FloatArray:
        """(dof,) displacements from the start to where those of a point count from."""
        system, start = point.system, self.start
        moved, turned = system.reference - start.position, system.angle0 - start.angle
        return np.concatenate([moved.T.ravel(), turned])[: system.dof]

    def towards(self, factor: float, step: float) -> float:
        """A load factor one ``step`` on, or the target where that is no more than a tenth of a step away."""
        return factor + self.direction * step if abs(self.target - factor) > 1.1 * step else self.target

    def resisted(self, system: StaticSystem, by: Factor, force: FloatArray) -> FloatArray:
        """Forces out of balance (dof,) without what events have left of them along motions that nothing resists."""
        held = least(system, solved_by(system, by), force)
        return held if largest(force - held) <= RATES.bare else force

    def ended(self, point: Point) -> Point | None:
        """The point at the target, if its load is that of the target to within the force of an event; else None."""
        if abs(self.target - point.factor) * self.unit > point.rate_problem.force:
            return None
        return replace(point, factor=self.target)

    def increased(self, point: Point, new: float) -> Trial | None:
        """Equilibrium with the return map, one increment on, whatever changes within it."""
        system, q, external = point.system, point.known.q, external_force(self.problem, new)
        guesses = [q if point.velocity is None else q + abs(new - point.factor) * point.velocity]
        if new in self.guide:
            guesses.append(self.guide[new] - self.origin(point))
        guesses = [system.displaced(one, new) for one in guesses]
        if len(guesses) > 1:  # a short increment is nearer by its rates, a long one by what was found before
            guesses.sort(key=lambda q: np.abs(system.trial(point.known, q).contact_force + external).max())
        return solve_increment(system, point.known, external, guesses[0], self.record)

    def balanced(self, point: Point) -> Point:
        """A start that dynamics alone has left nearly at rest: the equilibrium beside it."""
        external = external_force(self.problem, point.factor)
        if float(np.abs(point.trial.contact_force + external).max(initial=0.0)) < 10.0 * point.rate_problem.force:
            return point
        found = solve_increment(point.system, point.known, external, point.known.q, self.record)
        if found is None:
            raise PathError(
                f"no equilibrium beside the start at load factor {point.factor:g}: it is not at rest; "
                "take a smaller protocol.stop_kinetic_energy, or protocol.static_finish: true"
            )
        return point.on(point.factor, found)

    def look_down(self, load: float, disks: Dynamics | Point) -> None:
        """Raise where the first loaded disk has sunk too far."""
        if self.lowest > -np.inf and (height := float(disks.position[self.problem.load_disk[0], 1])) < self.lowest:
            raise Collapsed(load, height)

    def count(self, system: StaticSystem) -> None:
        """Add the factorisations of tangents with kept statuses to what the path has cost."""
        self.record.factorisations += system.renewals
        system.renewals = 0

    def kept(self, point: Point) -> State:
        """The certified state of a point."""
        trial, state = point.at_rest()
        spectrum = Spectrum(point.system, trial)
        undetermined, modes = spectrum.undetermined, diverging(spectrum)
        self.count(point.system)
        spent, certificate = self.record, certify(self.problem, state, modes=modes, undetermined=undetermined)
        reached = Reached("path", certificate, increments=spent.increments, factorisations=spent.factorisations)
        return replace(state, reached=reached)


def largest(values: FloatArray) -> float:
    """The largest size among numbers (k,); not a number where one of them is none."""
    return max(float(np.maximum.reduce(values)), -float(np.minimum.reduce(values)))
