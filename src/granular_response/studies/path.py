"""A scene under a growing load: its states along the load, and where something happens first.

A path goes from one contact event to the next. What the contacts alone decide (a first opening) changes at one of
them, whose load is exact. What the forces decide (two peaks) changes between two of them, where states are smooth in
the load, and is looked for in that piece alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..scene import Packing, Scene
from ..solvers.equilibrium import check_overlaps
from ..solvers.path import follow
from ..solvers.problem import Problem
from ..solvers.solution import Solution, loaded_states
from ..state import OPEN, STICKING, Event, State
from ..sweeps.rest import rest_state
from .brackets import First
from .search import bisect_event, first_change

#: What a path leaves of the force of an event, as a part of it.
EXACT = 1e-8

#: Width of the bracket of what changes between two events, as a part of the force.
NARROW = 1e-6


@dataclass(frozen=True)
class Happening:
    """Something that happens along a load path.

    Examples
    --------
    >>> deep = gr.studies.Happening(lambda state: state.position[:, 1].min() < 0.99, "a disk sinks into the floor")
    """

    happened: Callable[[State], bool]
    definition: str
    of_contacts: bool = False  #: whether which disks touch decides it
    #: Whether the events between two forces are looked at in turn, not by halves: a symmetric state that has lost its
    #: stability is left where a path ends, not where it only passes.
    in_turn: bool = False


@dataclass
class LoadPath:
    """States of one scene under a growing load, each found from the one below it.

    A force is a factor of the scene's loads: mean disk weights if there is one of unit force. With dynamics as the
    protocol (``method: dynamics``) every state starts at rest instead, as in the paper. A path stops
    (``solvers.path.Collapsed``) where the load has pushed its disk below ``lowest`` (mean radii).

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> path.at(0.5).load_factor, path.method
    (0.5, 'path')
    """

    scene: Scene
    problem: Problem  #: with the loaded disk chosen
    rest: State
    known: dict[float, State] = field(default_factory=dict)  #: by force
    lowest: float = -np.inf
    method: str = ""  #: by which the last states were found
    below: dict[float, float] = field(default_factory=dict)  #: by force, that from which its state was found

    @classmethod
    def of(cls, scene: Scene, rest: State | None = None, packing: Packing | None = None) -> LoadPath:
        """The path of ``scene``, or of ``packing`` in place of its own, settled under gravity unless ``rest`` is given.

        Raises SceneError for a scene that is not allowed, SolveError where it finds no equilibrium.

        Examples
        --------
        >>> gr.studies.LoadPath.of(result.scene.updated({"contact.friction": 0.5})).rest.certificate.stable
        True
        """
        problem = Problem.from_scene(scene, packing)
        rest = rest_state(problem) if rest is None else rest
        return cls(scene, problem.with_loads(rest.position), rest)

    @classmethod
    def from_solution(cls, solution: Solution) -> LoadPath:
        """The path that a solution with one growing load has begun."""
        known = {state.load_factor: state for state in solution.loaded}
        below = dict(zip(known, [0.0, *known], strict=False))
        return cls(solution.scene, solution.problem, solution.rest, known, below=below)

    def at(self, force: float) -> State:
        """The state under ``force``. Raises as :meth:`through`.

        Examples
        --------
        >>> gr.studies.LoadPath.of(result.scene).at(0.5).load_factor
        0.5
        """
        return self.through([force])[0]

    def through(self, forces: Iterable[float]) -> list[State]:
        """States at increasing ``forces``, each computed once. Raises SolveError where there is no equilibrium.

        Examples
        --------
        >>> [state.load_factor for state in gr.studies.LoadPath.of(result.scene).through([0.5, 1.0])]
        [0.5, 1.0]
        """
        forces = [float(force) for force in forces]
        wanted = [force for force in forces if force not in self.known]
        self.method = self.problem.plan.load.method
        literal = self.method == "dynamics"
        while wanted:
            below = max((f for f in self.known if f < wanted[0] and not literal), default=0.0)
            above = min((f for f in self.known if f > wanted[0]), default=np.inf)
            run = [force for force in wanted if force < above]
            start = self.known[below] if below else self.rest
            if self.method == "path":
                states = follow(self.problem, start, run, lowest=self.lowest)
            else:
                states = loaded_states(self.problem, start, run)[1]
            self.known.update(zip(run, states, strict=True))
            self.below.update(zip(run, [0.0] * len(run) if literal else [below, *run[:-1]], strict=True))
            wanted = wanted[len(run) :]
        return [self.known[force] for force in forces]

    def solution(self, force: float) -> Solution:
        """A solution of the scene: the state under ``force`` and those from which it was found.

        Raises as :meth:`through`.
        """
        self.at(force)
        way = [force]
        while below := self.below[way[0]]:
            way.insert(0, below)
        scene = self.scene.updated({"protocol.load_factors": way})
        for one in way:
            check_overlaps(self.problem, self.known[one])
        return Solution(scene, replace(self.problem, scene=scene), self.rest, tuple(self.known[f] for f in way))

    def first(
        self,
        forces: Sequence[float],
        happening: Happening,
        width: float = NARROW,
        *,
        tolerance: float | None = None,
        beside: float = 0.0,
    ) -> First:
        """Between which forces something happens first: after the one and not after the other.

        ``forces`` are neighbours on the path. The first of them at which it has happened is narrowed
        to the event of the path between it and the one before, or within a piece between two events to ``width`` (per
        force), or to an absolute ``tolerance``. Events are looked at exactly, or so far ``beside`` on both sides, where
        contacts have their status before and after.

        Examples
        --------
        >>> path = gr.studies.LoadPath.of(result.scene)
        >>> sought = gr.studies.happenings(gr.studies.Measures(path), path.at(0.1), 0.1)
        >>> low, high = path.first([0.1, 1.0, 4.0], sought["linear_range"])
        >>> low < high < 4.0
        True
        """
        low, high = found = first_change(forces, map(happening.happened, self.through(forces)))
        if not found.happened:
            return found
        passed = self.known[high].reached.events
        if happening.of_contacts:
            at = self._change(self.known.get(low, self.rest), passed, happening)
            if at is not None:
                within = max(EXACT * at, self.known[high].reached.events_within or 0.0)
                return First(max(at - within, low), min(at * (1.0 + EXACT), high))
        ends = _knots(low, high, passed, beside or width * high, beside)
        while len(ends) > 2:
            middle = 1 if happening.in_turn else len(ends) // 2
            ends = ends[: middle + 1] if happening.happened(self.at(ends[middle])) else ends[middle:]
        low, high = ends
        narrow = width * high if tolerance is None else tolerance
        if gone := lost([self.known[high]]):  # and no equilibrium from there on
            before = gone[0].load_factor - (beside or narrow)
            if before <= low or not happening.happened(self.at(before)):
                return First(max(before, low), high)
            high = before
            narrow = width * high if tolerance is None else tolerance
        if high - low > narrow:
            low, high = bisect_event(
                lambda force: happening.happened(self.at(force)), low, high, narrow, at_low=False, at_high=True
            ).ends
        return First(low, high)

    def _change(self, state: State, passed: Iterable[Event], happening: Happening) -> float | None:
        """The force of the event by which the contacts of ``state`` come to what has happened; None if by no event."""
        pairs = state.pairs
        place = {pair: k for k, pair in enumerate(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True))}
        for event in passed:
            k = None if event.at_wall else place.get((event.first, event.second))
            if k is None or event.kind not in ("opens", "closes"):
                continue
            status = pairs.status.copy()
            status[k] = OPEN if event.kind == "opens" else STICKING
            pairs = replace(pairs, status=status)
            if happening.happened(replace(state, pairs=pairs)):
                return event.load_factor
        return None


def _knots(low: float, high: float, events: Iterable[Event], apart: float, beside: float) -> list[float]:
    """``low``, ``high``, and the loads of events between them that are ``apart``, or those just ``beside`` each."""
    knots = [low]
    for force in sorted({end for event in events for end in (event.load_factor, event.until)}):
        if not low + apart < force < high - apart:
            continue
        if knots[-1] + apart < force:
            knots += [force - beside, force + beside] if beside else [force]
        elif beside:
            knots[-1] = force + beside
    return [*knots, high]


def lost(states: Iterable[State]) -> list[Event]:
    """Losses of equilibrium on the path through ``states``, in turn.

    Examples
    --------
    >>> gr.studies.lost(result.loaded)
    []
    """
    return [event for state in states for event in state.reached.events if event.lost]


def by_motion(state: State) -> bool:
    """Whether a dynamic jump, or motion to the next equilibrium, led from the state before to this one.

    Examples
    --------
    >>> gr.studies.by_motion(result.loaded[-1])
    False
    """
    return state.reached.method == "dynamics" or any(event.kind != "stepped over" for event in lost([state]))
