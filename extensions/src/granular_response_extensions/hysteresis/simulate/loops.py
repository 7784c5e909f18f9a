"""Loops of the load on one packing: what they leave, what work they take, and where that goes.

Inertia and dashpots have no part in a path: what a load does and the packing does not store has slid away
(``solvers.work``), but where an equilibrium is lost and the motion of the disks leads to the next one: what goes
there into dashpots and sliding together is booked apart.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from granular_response import studies
from granular_response.observe.floor import floor_force
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.solvers.work import slid, stored, work
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import Happening, LoadPath, Measures, bisect_event, by_motion
from granular_response.studies.measures import FIRST_OPENING, LINEARITY
from granular_response_paper.records import column, record

EVENTS = {
    "first_opening": FIRST_OPENING,
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
class ShownLoop:
    """What is drawn of the first packing of a case: the loop to the largest force."""

    load: FloatArray = column(f"load {WEIGHTS}", "branch", "point")
    displacement: FloatArray = column(f"of the loaded disk downwards {RADII}", "branch", "point")
    added: FloatArray = column(
        f"floor force at the end of the way, less that at rest {WEIGHTS}", "branch", "floor_disk"
    )
    x: FloatArray = column(f"rest position from the loaded disk {RADII}", "floor_disk")


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


class CycledPacking:
    """A packing, its first loading, and what is measured on it."""

    def __init__(self, scene: Scene, width: float) -> None:
        self.path = LoadPath.of(scene)
        self.measures, self.problem = Measures(self.path), self.path.problem
        self.centre = partial(self.measures.centre, width=width)  #: response of a state at x = 0
        self.known_left: dict[float, float] = {}  #: by force, what a loop to it leaves

    def added(self, state: State) -> FloatArray:
        """(disk,) floor forces that are not there at rest."""
        return floor_force(state, self.measures.disks) - floor_force(self.path.rest, self.measures.disks)

    def sunk(self, state: State) -> float:
        """How far the loaded disk is below where it rested."""
        return float((self.path.rest.position - state.position)[self.measures.loaded_disk, 1])

    def left_by(self, force: float) -> float:
        """Largest change of a floor force that unloading from ``force`` leaves, per largest change under the load."""
        if force not in self.known_left:
            loaded = self.path.at(force)
            (unloaded,) = loaded_states(self.problem, loaded, [0.0])[1]
            left, under = (np.abs(self.added(state)).max() for state in (unloaded, loaded))
            self.known_left[force] = float(left / under)
        return self.known_left[force]

    def turn(self, states: Sequence[State], turn: int, force: float, smallest: float) -> tuple[Turn, ShownLoop]:
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
        ways = np.array([[(state.load_factor, self.sunk(state)) for state in branch] for branch in branches])
        return measured, ShownLoop(ways[..., 0], ways[..., 1], added, self.measures.x)

    def events(self, forces: Sequence[float], left: float, tolerance: float) -> list[tuple[float, float]]:
        """Brackets of ``EVENTS``; see the module."""
        path, passed = self.path, sorted(self.path.known)
        linear = self.centre(path.known[forces[0]])
        opening = studies.first_opening(self.measures)
        nonlinear = Happening(lambda state: abs(self.centre(state) / linear - 1.0) > LINEARITY, EVENTS["linear_range"])
        # a loop is known of where the load turns alone, and to each further force it is a way of its own
        low, high = studies.first_change(forces, [self.left_by(force) > left for force in forces])
        if np.isfinite(high) and high - low > (width := tolerance * high):
            bracket = bisect_event(lambda at: self.left_by(at) > left, low, high, width, at_low=False, at_high=True)
            low, high = bracket.ends
        return [path.first(passed, opening), path.first(passed[passed.index(forces[0]) :], nonlinear), (low, high)]
