"""Loading, unloading and loading again: what is nonlinear, and what of that is irreversible.

Each packing is loaded along one path of equilibria. From every force F at which the load turns it goes back to none
and up to F again; the paths begin at the state that loading has reached, so that each loop is the first one of its
packing. Inertia and dashpots have no part in a path: what a load does and the packing does not store has slid away
(``solve.work``), but where dynamics crosses the end of a branch: what goes
there into dashpots and sliding together is booked apart.

Events, along the first loading: the first opening of a contact, the end of the linear range (the response at x = 0
differs by 1 % from that to the smallest force, as in Figs. 6 and 20), and the end of the reversible range: a loop to
that force leaves some floor force changed by more than a part of the largest change under the load.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.observe.floor import floor_force, smoothed_response
from granular_response.paper.datasets import labelled
from granular_response.paper.groups.hysteresis.parameters import Parameters
from granular_response.paper.slab_response import LINEARITY, Event, LoadPath, Measures, first_change, locate
from granular_response.scene import Scene
from granular_response.solve import Problem, loaded_states
from granular_response.solve.work import slid, stored, work
from granular_response.state import State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.tasks import Progress, map_tasks

FloatArray = NDArray[np.float64]

#: The three ways of a loop, in turn.
BRANCHES = ("loading", "unloading", "loading again")
EVENTS = ("first_opening", "linear_range", "reversible_range")
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
    "crossed": f"where dynamics had a part in the first loop, what was neither kept nor slid; else 0 {ENERGY}",
    "lost_again": f"work of the load round the second loop, from the load to the load {ENERGY}",
    "kept_again": f"energy that the packing has stored more after the second loop {ENERGY}",
    "slid_again": f"energy that sliding took in the second loop {ENERGY}",
    "crossed_again": f"where dynamics had a part in the second loop, what was neither kept nor slid; else 0 {ENERGY}",
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
class Outcome:
    measured: dict[str, FloatArray]  #: MEASURED, each (turn,)
    events: tuple[Event, ...]  #: EVENTS
    curve: FloatArray  #: (branch, point, 2) load and displacement of the loop to the largest force
    floor: FloatArray  #: (3, disk) floor forces added: by the load, left after it, by the second load
    x: FloatArray  #: (disk,)


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

    Sliding between two states with a crossing by dynamics is left out: nothing is known of the way between them.
    """
    pairs, walls, done, crosses = np.zeros(len(states[0].pairs.first)), 0.0, 0.0, False
    for before, after in pairwise(states):
        done += work(problem, before, after)
        if _crosses(before, after):
            crosses = True
            continue
        lost = slid(problem, before, after)
        pairs += lost.pairs
        walls += float(lost.walls.sum())
    return Books(done, stored(problem, states[-1]) - stored(problem, states[0]), pairs, walls, crosses)


def _crosses(before: State, after: State) -> bool:
    """Whether dynamics carried the packing over some of the load between neighbouring states of a path."""
    low, high = sorted((before.load_factor, after.load_factor))
    known = before.reached.crossings
    late = after.reached.crossings
    fresh = late[len(known) :] if late[: len(known)] == known else late
    return any(max(c.start, c.end) > low and min(c.start, c.end) < high for c in fresh)


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

    def opened(self, state: State) -> NDArray[np.bool_]:
        """(m,) candidates of both that touch at rest and not in ``state``, in the central third of the slab."""
        rest, there = common_candidates([self.path.rest, state], self.problem.packing.radius)
        width = self.problem.packing.width
        return rest.pairs.touching & ~there.pairs.touching & network.interior_contacts(rest, width, width / 3.0)

    def after(self, state: State, loads: Sequence[float]) -> list[State]:
        """States at ``loads`` in turn, from ``state`` on."""
        return loaded_states(self.problem, state, loads)[1]

    def left(self, loaded: State, unloaded: State) -> float:
        """Largest change of a floor force that is left, per largest change under the load."""
        return float(np.abs(self.added(unloaded)).max() / np.abs(self.added(loaded)).max())

    def events(self) -> tuple[Event, ...]:
        """See the module."""
        task, forces = self.task, self.task.forces
        linear = self.centre(self.path.known[forces[0]])
        asked: dict[str, tuple[Callable[[State], bool], str]] = {
            "first_opening": (
                lambda state: bool(self.opened(state).any()),
                "a contact of disks in the central third of the slab is open that touches at rest",
            ),
            "linear_range": (
                lambda state: abs(self.centre(state) / linear - 1.0) > LINEARITY,
                f"the response at x = 0 differs by more than {LINEARITY:.0%} from that at force {forces[0]:g}",
            ),
            "reversible_range": (
                lambda state: self.left(state, self.after(state, [0.0])[0]) > task.left,
                f"unloading leaves a floor force changed by more than {task.left:.0%} of the largest change",
            ),
        }
        found = []
        for name in EVENTS:
            happened, definition = asked[name]
            _, high = first_change(forces, [happened(self.path.known[force]) for force in forces])
            width = task.tolerance * high if np.isfinite(high) else np.inf
            found.append(locate(name, self.path, forces, happened, width, definition))
        return tuple(found)


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
        opened = states[0].pairs.touching & ~loaded.pairs.touching
        largest = np.abs(packing.added(loaded)).max()
        rows.append(
            {
                "floor_left": packing.left(loaded, unloaded),
                "floor_repeated": np.abs(packing.added(second) - packing.added(loaded)).max() / largest,
                "displacement": packing.sunk(loaded),
                "displacement_left": packing.sunk(unloaded),
                "displacement_repeated": packing.sunk(second),
                "nonlinearity": packing.centre(loaded) / linear - 1.0,
                "opened_contacts": packing.opened(first[turn]).sum(),
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
    return Outcome(
        {name: np.array([float(row[name]) for row in rows]) for name in MEASURED},
        packing.events(),
        curve,
        np.stack([packing.added(state) for state in (loaded, unloaded, second)]),
        packing.measures.x,
    )


def simulate(
    parameters: Parameters, *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``loops`` (case, realization, turn), ``events`` (case, realization, event), ``curves`` and ``floor``."""
    cases = parameters.cases
    places = [(c, r) for c, case in enumerate(cases) for r in range(case.realizations)]
    tasks = [
        Task(
            parameters.of(cases[c], r),
            cases[c].forces,
            cases[c].increments,
            parameters.left,
            parameters.width if cases[c].polydispersity else 0.0,
            parameters.tolerance,
        )
        for c, r in places
    ]
    # the longest ones first
    order = sorted(range(len(tasks)), key=lambda k: -tasks[k].forces[-1] * (tasks[k].scene.contact.friction > 0.0))
    done = map_tasks(compute, [tasks[k] for k in order], workers=workers, progress=progress, what="packings")
    outcomes = dict(zip([places[k] for k in order], done, strict=True))

    realizations = max(case.realizations for case in cases)
    turns = max(len(case.forces) for case in cases)
    force = np.full((len(cases), turns), np.nan)
    measured = {name: np.full((len(cases), realizations, turns), np.nan) for name in MEASURED}
    low, high = np.full((2, len(cases), realizations, len(EVENTS)), np.nan)
    for c, case in enumerate(cases):
        force[c, : len(case.forces)] = case.forces
    for place, outcome in outcomes.items():
        for name, values in outcome.measured.items():
            measured[name][(*place, slice(len(values)))] = values
        low[place] = [event.low for event in outcome.events]
        high[place] = [event.high for event in outcome.events]
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
            "definition": variable(
                "event", [event.definition for event in outcomes[places[0]].events], "what counts as the event"
            ),
        },
        coords=coordinates | {"event": variable("event", list(EVENTS), "what happens")},
    )
    events.attrs["left"] = parameters.left
    shown = [outcomes[c, 0] for c in range(len(cases))]
    return labelled({"loops": loops, "events": events, **_shown(shown, coordinates)}, parameters.base)


def _shown(shown: Sequence[Outcome], coordinates: dict[str, xr.Variable]) -> dict[str, xr.Dataset]:
    """The loop to the largest force of the first packing of each case."""
    points = max(outcome.curve.shape[1] for outcome in shown)
    disks = max(len(outcome.x) for outcome in shown)
    curves = np.full((len(shown), len(BRANCHES), points, 2), np.nan)
    floor = np.full((len(shown), len(BRANCHES), disks), np.nan)
    x = np.full((len(shown), disks), np.nan)
    for c, outcome in enumerate(shown):
        curves[c, :, : outcome.curve.shape[1]] = outcome.curve
        floor[c, :, : len(outcome.x)] = outcome.floor
        x[c, : len(outcome.x)] = outcome.x
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
