"""Loading, unloading and loading again: what is nonlinear, and what of that is irreversible.

Each packing is loaded along one path of equilibria. From every force F at which the load turns it goes back to none
and up to F again; the paths begin at the state that loading has reached, so that each loop is the first one of its
packing. Inertia and dashpots have no part in a path: what a load does and the packing does not store has slid away
(``solvers.work``), but where an equilibrium is lost and the motion of the disks leads to the next one: what goes
there into dashpots and sliding together is booked apart.

Events, along the first loading: the first opening of a contact, the end of the linear range (the response at x = 0
differs by 1 % from that to the smallest force, as in Figs. 6 and 20), and the end of the reversible range: a loop to
that force leaves some floor force changed by more than a part of the largest change under the load.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import xarray as xr

from granular_response.observe.events import bisect_event
from granular_response.observe.floor import floor_force
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.work import slid, stored, work
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.hysteresis.parameters import Parameters
from granular_response_paper.records import axes, column, columns, labels, record, stacked, table
from granular_response_paper.slab_response import LINEARITY, Happening, LoadPath, Measures, by_motion
from granular_response_paper.survey.packings import measured

#: The three ways of a loop, in turn.
BRANCHES = ("loading", "unloading", "loading again")
EVENTS = {
    "first_opening": slab.FIRST_OPENING,
    "linear_range": f"the response at x = 0 differs by more than {LINEARITY:.0%} from that at the smallest force",
    "reversible_range": "unloading leaves a floor force changed by more than the part left of the largest change",
}
ENERGY = "in mean disk weight times mean radius"


@record
class Turn:
    """What is measured at a force at which the load turns."""

    floor_left: float = column("largest change of a floor force that a loop leaves, per largest change under the load")
    floor_repeated: float = column(
        "largest difference of a floor force under the load, second and first time, per largest change"
    )
    displacement: float = column(f"of the loaded disk downwards, first loading {RADII}")
    displacement_left: float = column(f"of the loaded disk downwards, after unloading {RADII}")
    displacement_repeated: float = column(f"of the loaded disk downwards, second loading {RADII}")
    nonlinearity: float = column("response at x = 0, per that to the smallest force, minus 1")
    opened_contacts: float = column("contacts of disks in the central third that touch at rest and not under load")
    sliding_contacts: float = column("contacts at the Coulomb limit under load")
    work: float = column(f"of the load on the first loading {ENERGY}")
    lost: float = column(f"work of the load round the first loop, from rest to rest {ENERGY}")
    kept: float = column(f"energy that the packing has stored more after the first loop {ENERGY}")
    slid: float = column(f"energy that sliding took in the first loop {ENERGY}")
    slid_walls: float = column(f"the part of that at floor and side walls {ENERGY}")
    slid_opened: float = column(f"the part of that in contacts which touch at rest and not under load {ENERGY}")
    crossed: float = column(f"where disks jumped in the first loop, what was neither kept nor slid; else 0 {ENERGY}")
    lost_again: float = column(f"work of the load round the second loop, from the load to the load {ENERGY}")
    kept_again: float = column(f"energy that the packing has stored more after the second loop {ENERGY}")
    slid_again: float = column(f"energy that sliding took in the second loop {ENERGY}")
    crossed_again: float = column(
        f"where disks jumped in the second loop, what was neither kept nor slid; else 0 {ENERGY}"
    )


@record
class Bracket:
    low: float = column(f"force before the event {WEIGHTS}; 0: happened at the first one")
    high: float = column(f"force at which it has happened {WEIGHTS}; nan: not up to low")


@record
class Shown:
    """What is drawn of the first packing of a case: the loop to the largest force."""

    load: FloatArray = column(f"load {WEIGHTS}", "branch", "point")
    displacement: FloatArray = column(f"of the loaded disk downwards {RADII}", "branch", "point")
    added: FloatArray = column(
        f"floor force at the end of the way, less that at rest {WEIGHTS}", "branch", "floor_disk"
    )
    x: FloatArray = column(f"rest position from the loaded disk {RADII}", "floor_disk")


@record
class Outcome:
    """One packing; ``measured`` has a :class:`Turn` in each line, ``brackets`` a :class:`Bracket` of EVENTS."""

    measured: FloatArray = column("; ".join(one.long_name for one in columns(Turn).values()), "line", "quantity")
    brackets: FloatArray = column(
        f"forces {WEIGHTS} before and at: {', '.join(EVENTS)}; nan: not up to low", "event", "bracket"
    )
    shown: Shown | None = None  #: not of the survey's


@record
class Key:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column("friction between disks")
    realization: int = column("realization of the disorder")


@dataclass(frozen=True)
class Books:
    """Energies along a way or several."""

    work: float
    stored: float
    pairs: FloatArray  #: (m,) taken by sliding, along the common candidates of the states
    walls: float
    crosses: int  #: how often dynamics carried the packing over a part

    def __add__(self, other: Books) -> Books:
        return Books(*map(operator.add, astuple(self), astuple(other)))

    @property
    def slid(self) -> float:
        return float(self.pairs.sum()) + self.walls

    @property
    def crossed(self) -> float:
        """Where dynamics had a part, what is neither stored nor slid; 0 elsewhere."""
        return self.work - self.stored - self.slid if self.crosses else 0.0

    def loop(self, again: str = "") -> dict[str, float]:
        """The fields of a :class:`Turn` for a loop, those of the second one with ``_again`` behind their names."""
        found = {"lost": self.work, "kept": self.stored, "slid": self.slid, "crossed": self.crossed}
        return {name + again: value for name, value in found.items()}


def keep_books(problem: Problem, states: Sequence[State]) -> Books:
    """Where the work of the load goes along ``states``, with common candidates.

    Sliding between two states is left out where the motion of the disks led from one to the other: nothing is known of
    the way between them.
    """
    pairs, walls, done, crosses = np.zeros(len(states[0].pairs.first)), 0.0, 0.0, 0
    for before, after in pairwise(states):
        done += work(problem, before, after)
        if by_motion(after):
            crosses += 1
            continue
        lost = slid(problem, before, after)
        pairs += lost.pairs
        walls += float(lost.walls.sum())
    return Books(done, stored(problem, states[-1]) - stored(problem, states[0]), pairs, walls, crosses)


def grid(forces: Sequence[float], increments: int) -> list[float]:
    """Loads of all ways, from 0 on: ``increments`` steps to each of ``forces`` from the one before.

    Loading and unloading pass the same loads, so where they pass the same states their works cancel to the last digits.
    """
    steps = [0.0]
    for before, force in pairwise((0.0, *forces)):
        steps += [before + (force - before) * k / increments for k in range(1, increments)] + [force]
    return steps


class Packing:
    """A packing, its first loading, and what is measured on it."""

    def __init__(self, scene: Scene, width: float) -> None:
        self.path = LoadPath.of(scene)
        self.measures = Measures(self.path)
        self.problem = self.path.problem
        self.disk = int(self.problem.load_disk[0])
        self.width = width
        self.known_left: dict[float, float] = {}  #: by force, what a loop to it leaves

    def added(self, state: State) -> FloatArray:
        """(disk,) floor forces that are not there at rest."""
        return floor_force(state, self.measures.disks) - floor_force(self.path.rest, self.measures.disks)

    def sunk(self, state: State) -> float:
        """How far the loaded disk is below where it rested."""
        return float(self.path.rest.position[self.disk, 1] - state.position[self.disk, 1])

    def centre(self, state: State) -> float:
        """Response at x = 0."""
        return self.measures.centre(state, self.width)

    def left_by(self, force: float) -> float:
        """Largest change of a floor force that unloading from ``force`` leaves, per largest change under the load."""
        if force not in self.known_left:
            loaded = self.path.at(force)
            unloaded = loaded_states(self.problem, loaded, [0.0])[1][0]
            left, under = (np.abs(self.added(state)).max() for state in (unloaded, loaded))
            self.known_left[force] = float(left / under)
        return self.known_left[force]

    def turn(self, states: Sequence[State], turn: int, force: float, smallest: float) -> tuple[Turn, Shown]:
        """What is found on the ``states`` of two loops from rest on, which turn at place ``turn`` and at ``force``.

        ``smallest`` is the force up to which the response counts as linear.
        """
        branches = states[: turn + 1], states[turn : 2 * turn + 1], states[2 * turn :]
        once, down, more = (keep_books(self.problem, branch) for branch in branches)
        loop, second_loop = once + down, down + more
        loaded, unloaded, second = (branch[-1] for branch in branches)
        opened = states[0].pairs.touching & ~loaded.pairs.touching
        added = np.stack([self.added(state) for state in (loaded, unloaded, second)])
        largest, left, repeated = np.abs([added[0], added[1], added[2] - added[0]]).max(axis=1)
        self.known_left[force] = float(left / largest)
        measured = Turn(
            floor_left=self.known_left[force],
            floor_repeated=repeated / largest,
            displacement=self.sunk(loaded),
            displacement_left=self.sunk(unloaded),
            displacement_repeated=self.sunk(second),
            nonlinearity=self.centre(loaded) / self.centre(self.path.known[smallest]) - 1.0,
            opened_contacts=self.measures.opened(self.path.known[force]),
            sliding_contacts=loaded.pairs.sliding.sum() + loaded.walls.sliding.sum(),
            work=once.work,
            slid_walls=loop.walls,
            slid_opened=loop.pairs[opened].sum(),
            **loop.loop(),
            **second_loop.loop("_again"),
        )
        load = np.array([[state.load_factor for state in branch] for branch in branches])
        sunk = np.array([[self.sunk(state) for state in branch] for branch in branches])
        return measured, Shown(load, sunk, added, self.measures.x)

    def events(self, forces: Sequence[float], left: float, tolerance: float) -> list[tuple[float, float]]:
        """Brackets of ``EVENTS``; see the module."""
        path, passed = self.path, sorted(self.path.known)
        linear = self.centre(path.known[forces[0]])
        opening = slab.first_opening(self.measures)
        nonlinear = Happening(lambda state: abs(self.centre(state) / linear - 1.0) > LINEARITY, EVENTS["linear_range"])
        # a loop is known of where the load turns alone, and to each further force it is a way of its own
        low, high = slab.first_change(forces, [self.left_by(force) > left for force in forces])
        if np.isfinite(high) and high - low > tolerance * high:
            found = bisect_event(
                lambda force: self.left_by(force) > left, low, high, tolerance * high, at_low=False, at_high=True
            )
            low, high = found.low, found.high
        return [path.first(passed, opening), path.first(passed[passed.index(forces[0]) :], nonlinear), (low, high)]


def compute(
    scene: Scene, forces: Sequence[float], increments: int, left: float, width: float, tolerance: float
) -> Outcome:
    """One packing.

    ``width`` is that of the Gaussian at x = 0; 0 for a lattice, whose response is not smoothed. Raises what
    ``LoadPath.of`` and ``loaded_states`` raise.
    """
    packing = Packing(scene, width)
    path, radius = packing.path, packing.problem.packing.radius
    loads = grid(forces, increments)
    first = [path.rest, *path.through(loads[1:])]
    found = []
    for force in forces:
        turn = loads.index(force)
        ways = [*loads[turn - 1 :: -1], *loads[1 : turn + 1]]
        further = loaded_states(packing.problem, first[turn], ways)[1]
        states = common_candidates([*first[: turn + 1], *further], radius)
        found.append(packing.turn(states, turn, force, forces[0]))
    return Outcome(
        np.array([astuple(turn) for turn, _ in found], float),
        np.array(packing.events(forces, left, tolerance)),
        found[-1][1],
    )


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``loops`` (case, realization, turn), ``events`` (case, realization, event), ``curves`` and ``floor``."""
    cases = parameters.cases

    def work(place: tuple[int, int]) -> float:
        """Roughly how long a packing takes: friction, then how far it is loaded."""
        case = cases[place[0]]
        return case.forces[-1] * (1.0 + 10.0 * (case.friction > 0.0))

    outcomes = measured(parameters, "packings", packings, task, Outcome, work=work)
    along = ("case", "realization")
    coordinates = labels("case", cases, polydispersity="polydispersity", friction="friction between disks")
    loops = table(
        {(*place, t): Turn(*row) for place, one in outcomes.items() for t, row in enumerate(one.measured)},
        *along, "turn",
    )  # fmt: skip
    force = stacked({(c,): case.forces for c, case in enumerate(cases)}, float)
    loops["force"] = variable(("case", "turn"), force, f"force at which the load turns {WEIGHTS}")
    events = table(
        {(*place, e): Bracket(*ends) for place, one in outcomes.items() for e, ends in enumerate(one.brackets)},
        *along, "event",
    )  # fmt: skip
    events["definition"] = variable("event", list(EVENTS.values()), "what counts as the event")
    events.attrs["left"] = parameters.left
    shown = table([outcomes[c, 0].shown for c in range(len(cases))], "case")
    shown = shown.assign_coords(coordinates | axes(branch=(BRANCHES, "way")))
    datasets = {
        "loops": loops.assign_coords(coordinates),
        "events": events.assign_coords(coordinates | axes(event=(EVENTS, "what happens"))),
        "curves": shown[["load", "displacement"]],
        "floor": shown[["added", "x"]],
    }
    return labelled(datasets, parameters.base)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int], Key]:
    """The packings of the survey, or all others, by their cases and realizations."""
    return {
        (c, r): Key(case.polydispersity, case.friction, r)
        for c, case in enumerate(parameters.cases)
        for r in range(case.realizations + case.surveyed)
        if (r >= case.realizations) == surveyed
    }


def task(parameters: Parameters, key: Key) -> partial[Outcome]:
    """One of these packings."""
    case = next(one for one in parameters.cases if (one.polydispersity, one.friction) == astuple(key)[:2])
    width = parameters.width if case.polydispersity else 0.0
    scene = parameters.of(case, key.realization)
    return partial(compute, scene, case.forces, case.increments, parameters.left, width, parameters.tolerance)
