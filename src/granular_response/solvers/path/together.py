"""Increments of the load that take events together, for large packings, and what they leave out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...state import FloatArray, State
from . import events
from .losses import relisted
from .points import Leg, Point


@dataclass
class Together:
    """Steps by increments of a ``load`` (mean weights) with the return map.

    Where one has no equilibrium events are taken one by one up to its end.
    """

    leg: Leg
    load: float

    @classmethod
    def asked(cls, leg: Leg, point: Point, load: float | None) -> Together | None:
        """As asked for, by default in large packings only; None where events are taken one by one."""
        if load is None and point.system.pattern.dissected:
            load = leg.options.together * leg.problem.n**0.5
        # in two increments at least, or there are none of twice the length
        load = min(load or 0.0, 0.5 * leg.whole)
        return cls(leg, load) if load else None

    def begin(self) -> None:
        self.passed: dict[float, FloatArray] = {}  #: (dof,) displacements since the start at the ends of increments
        self.singly_until = self.leg.start.load_factor

    def step(self, point: Point) -> Point | None:
        """The end of the next increment; None where events are taken one by one."""
        leg = self.leg
        if leg.direction * (point.factor - self.singly_until) < 0.0:
            return None
        ahead = [factor for factor in leg.guide if leg.direction * (factor - point.factor) > 0.0]
        new = ahead[:2][-1] if ahead else leg.towards(point.factor, self.load / leg.unit)
        found = leg.increased(point, new)
        if found is None:
            self.singly_until = new
            return None
        q = found.configuration.q
        self.passed[new] = leg.origin(point) + q
        leg.record.events += events.changes(replace(point, factor=new), found.sense)
        velocity = (q - point.known.q) / abs(new - point.factor)
        return relisted(leg, replace(point, velocity=velocity).on(new, found))

    def coarser(self) -> Together:
        """Increments of twice the length, whose guesses are what these have found."""
        self.leg.guide = self.passed
        return Together(self.leg, 2.0 * self.load)

    def judged(self, state: State, coarse: State | None) -> State:
        """A state with the difference that coarser increments make, if they have led to one: what these leave out."""
        leg, error = self.leg, np.inf
        if coarse is not None and coarse.walls.same_candidates(state.walls):
            error = float(np.abs(state.wall_force() - coarse.wall_force()).max(initial=0.0)) / leg.whole
        leg.record.events[leg.begun :] = state.reached.events
        work = leg.record
        reached = replace(state.reached, increments=work.increments, factorisations=work.factorisations)
        return replace(state, reached=replace(reached, events_within=self.load, events_error=error))
