"""Loading, unloading and loading again: what is nonlinear, and what of that is irreversible.

Each packing is loaded along one path of equilibria. From every force F at which the load turns it goes back to none
and up to F again; the paths begin at the state that loading has reached, so that each loop is the first one of its
packing. Inertia and dashpots have no part in a path: what a load does and the packing does not store has slid away
(``solve.work``), but where an equilibrium is lost and the motion of the disks leads to the next one: what goes
there into dashpots and sliding together is booked apart.

Events, along the first loading: the first opening of a contact, the end of the linear range (the response at x = 0
differs by 1 % from that to the smallest force, as in Figs. 6 and 20), and the end of the reversible range: a loop to
that force leaves some floor force changed by more than a part of the largest change under the load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr

from granular_response.observe.events import bisect_event
from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.scene import Scene
from granular_response.solve import Problem, loaded_states
from granular_response.solve.work import slid, stored, work
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.hysteresis.parameters import Parameters
from granular_response_paper.slab_response import (
    LINEARITY,
    Happening,
    LoadPath,
    Measures,
    by_motion,
    first_change,
)
from granular_response_paper.survey.packings import Key, Layout, chosen

#: The three ways of a loop, in turn.
BRANCHES = ("loading", "unloading", "loading again")
EVENTS = {
    "first_opening": "a contact of disks in the central third of the slab is open that touches at rest",
    "linear_range": f"the response at x = 0 differs by more than {LINEARITY:.0%} from that at the smallest force",
    "reversible_range": "unloading leaves a floor force changed by more than the part left of the largest change",
}
ENERGY = "in mean disk weight times mean radius"

#: What is measured at each force at which the load turns, with long names.
MEASURED = {
    "floor_left": "largest change of a floor force that a loop leaves, per largest change under the load",
    "floor_repeated": "largest difference of a floor force under the load, second and first time, per largest change",
    "displacement": f"of the loaded disk downwards, first loading {LENGTH}",
    "displacement_left": f"of the loaded disk downwards, after unloading {LENGTH}",
    "displacement_repeated": f"of the loaded disk downwards, second loading {LENGTH}",
    "nonlinearity": "response at x = 0, per that to the smallest force, minus 1",
    "opened_contacts": "contacts of disks in the central third that touch at rest and not under load",
    "sliding_contacts": "contacts at the Coulomb limit under load",
    "work": f"of the load on the first loading {ENERGY}",
    "lost": f"work of the load round the first loop, from rest to rest {ENERGY}",
    "kept": f"energy that the packing has stored more after the first loop {ENERGY}",
    "slid": f"energy that sliding took in the first loop {ENERGY}",
    "slid_walls": f"the part of that at floor and side walls {ENERGY}",
    "slid_opened": f"the part of that in contacts which touch at rest and not under load {ENERGY}",
    "crossed": f"where disks jumped in the first loop, what was neither kept nor slid; else 0 {ENERGY}",
    "lost_again": f"work of the load round the second loop, from the load to the load {ENERGY}",
    "kept_again": f"energy that the packing has stored more after the second loop {ENERGY}",
    "slid_again": f"energy that sliding took in the second loop {ENERGY}",
    "crossed_again": f"where disks jumped in the second loop, what was neither kept nor slid; else 0 {ENERGY}",
}


@dataclass(frozen=True)
class Task:
    """One packing."""

    scene: Scene
    forces: tuple[float, ...]
    increments: int
    left: float
    width: float  #: of the Gaussian at x = 0; 0 for a lattice, whose response is not smoothed
    tolerance: float


@dataclass(frozen=True)
class Shown:
    """What is drawn of the first packing of a case."""

    curve: FloatArray  #: (branch, point, 2) load and displacement of the loop to the largest force
    floor: FloatArray  #: (3, disk) floor forces added: by the load, left after it, by the second load
    x: FloatArray  #: (disk,)


@dataclass(frozen=True)
class Outcome:
    measured: FloatArray  #: (turn, quantity) of MEASURED
    brackets: FloatArray  #: (event, 2) of EVENTS
    shown: Shown | None = None  #: not of the survey's


#: How the survey stores packings.
STORED = Layout(
    Outcome,
    {
        "polydispersity": "polydispersity",
        "friction": "friction between disks",
        "realization": "realization of the disorder",
    },
    {
        "measured": (("line", "quantity"), "; ".join(MEASURED.values())),
        "brackets": (("event", "bracket"), f"forces {FORCE} before and at: {', '.join(EVENTS)}; nan: not up to low"),
    },
)


@dataclass(frozen=True)
class Books:
    """Energies along a way or several."""

    work: float
    stored: float
    pairs: FloatArray  #: (m,) taken by sliding, along the common candidates of the states
    walls: float
    crosses: bool  #: whether dynamics carried the packing over a part

    def __add__(self, other: Books) -> Books:
        return Books(
            self.work + other.work,
            self.stored + other.stored,
            self.pairs + other.pairs,
            self.walls + other.walls,
            self.crosses or other.crosses,
        )

    @property
    def slid(self) -> float:
        return float(self.pairs.sum()) + self.walls

    @property
    def crossed(self) -> float:
        """Where dynamics had a part, what is neither stored nor slid; 0 elsewhere."""
        return self.work - self.stored - self.slid if self.crosses else 0.0


def keep_books(problem: Problem, states: Sequence[State]) -> Books:
    """Where the work of the load goes along ``states``, with common candidates.

    Sliding between two states is left out where the motion of the disks led from one to the other: nothing is known of
    the way between them.
    """
    pairs, walls, done, crosses = np.zeros(len(states[0].pairs.first)), 0.0, 0.0, False
    for before, after in pairwise(states):
        done += work(problem, before, after)
        if by_motion(after):
            crosses = True
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


@dataclass
class Packing:
    """A packing, its first loading, and what is measured on it."""

    task: Task

    def __post_init__(self) -> None:
        self.path = LoadPath.of(self.task.scene)
        self.measures = Measures(self.path)
        self.problem = self.path.problem
        self.disk = int(self.problem.load_disk[0])
        #: by force, what a loop to it leaves
        self.known_left: dict[float, float] = {}

    def added(self, state: State) -> FloatArray:
        """(disk,) floor forces that are not there at rest."""
        return floor_force(state, self.measures.disks) - floor_force(self.path.rest, self.measures.disks)

    def sunk(self, state: State) -> float:
        """How far the loaded disk is below where it rested."""
        return float(self.path.rest.position[self.disk, 1] - state.position[self.disk, 1])

    def centre(self, state: State) -> float:
        """Response at x = 0, under a disordered packing smoothed."""
        if not self.task.width:
            return self.measures.centre(state)
        response = self.measures.response(state)
        return float(smoothed_response([0.0], self.measures.x, response, self.task.width)[0])

    def after(self, state: State, loads: Sequence[float]) -> list[State]:
        """States at ``loads`` in turn, from ``state`` on."""
        return loaded_states(self.problem, state, loads)[1]

    def left(self, loaded: State, unloaded: State) -> float:
        """Largest change of a floor force that is left, per largest change under the load."""
        return float(np.abs(self.added(unloaded)).max() / np.abs(self.added(loaded)).max())

    def left_by(self, state: State) -> float:
        """The same for the way from ``state`` to no load; known ones are not gone again."""
        force = state.load_factor
        if force not in self.known_left:
            self.known_left[force] = self.left(state, self.after(state, [0.0])[0])
        return self.known_left[force]

    def events(self) -> list[tuple[float, float]]:
        """Brackets of ``EVENTS``; see the module."""
        task, path, forces = self.task, self.path, self.task.forces
        passed = sorted(path.known)
        linear = self.centre(path.known[forces[0]])
        opening, nonlinear = (
            Happening(lambda state: self.measures.opened(state) > 0, EVENTS["first_opening"], of_contacts=True),
            Happening(lambda state: abs(self.centre(state) / linear - 1.0) > LINEARITY, EVENTS["linear_range"]),
        )
        # a loop is known of where the load turns alone, and to each further force it is a way of its own
        low, high = first_change(forces, [self.left_by(path.known[force]) > task.left for force in forces])
        if np.isfinite(high) and high - low > task.tolerance * high:
            found = bisect_event(
                lambda force: self.left_by(path.at(force)) > task.left, low, high, task.tolerance * high,
                at_low=False, at_high=True,
            )  # fmt: skip
            low, high = found.low, found.high
        return [path.first(passed, opening), path.first(passed[passed.index(forces[0]) :], nonlinear), (low, high)]


def compute(task: Task) -> Outcome:
    """Raises what ``LoadPath.of`` and ``loaded_states`` raise."""
    packing = Packing(task)
    path, problem, radius = packing.path, packing.problem, packing.problem.packing.radius
    loads = grid(task.forces, task.increments)
    first = [path.rest, *path.through(loads[1:])]
    linear = packing.centre(path.known[task.forces[0]])
    rows = []
    for force in task.forces:
        turn = loads.index(force)
        ways = [*loads[turn - 1 :: -1], *loads[1 : turn + 1]]
        states = common_candidates([*first[: turn + 1], *packing.after(first[turn], ways)], radius)
        bottom = 2 * turn
        up, back, again = states[: turn + 1], states[turn : bottom + 1], states[bottom:]
        once, down, more = (keep_books(problem, branch) for branch in (up, back, again))
        loop, second_loop = once + down, down + more
        loaded, unloaded, second = states[turn], states[bottom], states[-1]
        packing.known_left[force] = packing.left(loaded, unloaded)
        opened = states[0].pairs.touching & ~loaded.pairs.touching
        largest = np.abs(packing.added(loaded)).max()
        rows.append(
            {
                "floor_left": packing.known_left[force],
                "floor_repeated": np.abs(packing.added(second) - packing.added(loaded)).max() / largest,
                "displacement": packing.sunk(loaded),
                "displacement_left": packing.sunk(unloaded),
                "displacement_repeated": packing.sunk(second),
                "nonlinearity": packing.centre(loaded) / linear - 1.0,
                "opened_contacts": packing.measures.opened(first[turn]),
                "sliding_contacts": loaded.pairs.sliding.sum() + loaded.walls.sliding.sum(),
                "work": once.work,
                "lost": loop.work,
                "kept": loop.stored,
                "slid": loop.slid,
                "slid_walls": loop.walls,
                "slid_opened": loop.pairs[opened].sum(),
                "crossed": loop.crossed,
                "lost_again": second_loop.work,
                "kept_again": second_loop.stored,
                "slid_again": second_loop.slid,
                "crossed_again": second_loop.crossed,
            }
        )
    curve = np.full((len(BRANCHES), len(loads), 2), np.nan)
    for b, branch in enumerate((up, back, again)):
        curve[b, : len(branch)] = [(state.load_factor, packing.sunk(state)) for state in branch]
    added = np.stack([packing.added(state) for state in (loaded, unloaded, second)])
    return Outcome(
        np.array([[float(row[name]) for name in MEASURED] for row in rows]),
        np.array(packing.events()),
        Shown(curve, added, packing.measures.x),
    )


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``loops`` (case, realization, turn), ``events`` (case, realization, event), ``curves`` and ``floor``."""
    cases = parameters.cases
    places = [(c, r) for c, case in enumerate(cases) for r in range(case.realizations)]
    tasks = {place: _task(parameters, *place) for place in places}
    # the longest ones first, so that no worker is left with one at the end
    order = sorted(places, key=lambda place: -_work(tasks[place]))
    done = map_tasks(compute, [tasks[place] for place in order], what="packings")
    outcomes = dict(zip(order, done, strict=True))
    keys = {place: key(parameters, *place) for place in _surveyed(parameters)}
    outcomes |= chosen(parameters.survey_file, STORED, keys)

    realizations = max(case.realizations + case.surveyed for case in cases)
    turns = max(len(case.forces) for case in cases)
    force = np.full((len(cases), turns), np.nan)
    measured = {name: np.full((len(cases), realizations, turns), np.nan) for name in MEASURED}
    low, high = np.full((2, len(cases), realizations, len(EVENTS)), np.nan)
    for c, case in enumerate(cases):
        force[c, : len(case.forces)] = case.forces
    for place, outcome in outcomes.items():
        for name, values in zip(MEASURED, outcome.measured.T, strict=True):
            measured[name][(*place, slice(len(values)))] = values
        low[place], high[place] = outcome.brackets.T
    coordinates = {
        "polydispersity": variable("case", [case.polydispersity for case in cases], "polydispersity"),
        "friction": variable("case", [case.friction for case in cases], "friction between disks"),
    }
    along = ("case", "realization", "turn")
    loops = xr.Dataset(
        {name: variable(along, measured[name], text) for name, text in MEASURED.items()}
        | {"force": variable(("case", "turn"), force, f"force at which the load turns {FORCE}")},
        coords=coordinates,
    )
    events = xr.Dataset(
        {
            "low": variable(
                (*along[:2], "event"), low, f"force before the event {FORCE}; 0: happened at the first one"
            ),
            "high": variable(
                (*along[:2], "event"), high, f"force at which it has happened {FORCE}; nan: not up to low"
            ),
            "definition": variable("event", list(EVENTS.values()), "what counts as the event"),
        },
        coords=coordinates | {"event": variable("event", list(EVENTS), "what happens")},
    )
    events.attrs["left"] = parameters.left
    first = [outcomes[c, 0].shown for c in range(len(cases))]
    shown = _shown([one for one in first if one is not None], coordinates)
    return labelled({"loops": loops, "events": events, **shown}, parameters.base)


def _surveyed(parameters: Parameters) -> list[tuple[int, int]]:
    """Places of the packings that are left to the survey: of the case, and the realization."""
    return [(c, case.realizations + more) for c, case in enumerate(parameters.cases) for more in range(case.surveyed)]


def key(parameters: Parameters, c: int, r: int) -> Key:
    """What tells a packing from others, as :data:`STORED` names it."""
    case = parameters.cases[c]
    return case.polydispersity, case.friction, r


def survey(parameters: Parameters) -> dict[Key, Task]:
    """The packings that are left to the survey."""
    return {key(parameters, *place): _task(parameters, *place) for place in _surveyed(parameters)}


def _task(parameters: Parameters, c: int, r: int) -> Task:
    case = parameters.cases[c]
    return Task(
        parameters.of(case, r),
        case.forces,
        case.increments,
        parameters.left,
        parameters.width if case.polydispersity else 0.0,
        parameters.tolerance,
    )


def _work(task: Task) -> float:
    """Roughly how long a packing takes: friction, then how far it is loaded."""
    return task.forces[-1] * (1.0 + 10.0 * (task.scene.contact.friction > 0.0))


def _shown(shown: Sequence[Shown], coordinates: dict[str, xr.Variable]) -> dict[str, xr.Dataset]:
    """The loop to the largest force of the first packing of each case."""
    points = max(one.curve.shape[1] for one in shown)
    disks = max(len(one.x) for one in shown)
    curves = np.full((len(shown), len(BRANCHES), points, 2), np.nan)
    floor = np.full((len(shown), len(BRANCHES), disks), np.nan)
    x = np.full((len(shown), disks), np.nan)
    for c, one in enumerate(shown):
        curves[c, :, : one.curve.shape[1]] = one.curve
        floor[c, :, : len(one.x)] = one.floor
        x[c, : len(one.x)] = one.x
    branch = {"branch": variable("branch", list(BRANCHES), "way")}
    dims = ("case", "branch", "point")
    return {
        "curves": xr.Dataset(
            {
                "load": variable(dims, curves[..., 0], f"load {FORCE}"),
                "displacement": variable(dims, curves[..., 1], f"of the loaded disk downwards {LENGTH}"),
            },
            coords=coordinates | branch,
        ),
        "floor": xr.Dataset(
            {
                "added": variable(
                    ("case", "branch", "floor_disk"),
                    floor,
                    f"floor force at the end of the way, less that at rest {FORCE}",
                ),
                "x": variable(("case", "floor_disk"), x, f"rest position from the loaded disk {LENGTH}"),
            },
            coords=coordinates | branch,
        ),
    }
