"""The driver of large packings: increments of the load that take events together, and what they leave out."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from ...errors import SolveError
from ...state import FloatArray, State
from ..rates import Rates
from . import events
from .losses import relisted
from .points import OPTIONS, Leg, Point
from .singly import Singly, followed


class Together(Singly):
    """Steps of increments of a load (mean weights) with the return map; event by event where one has no equilibrium."""

    def __init__(self, leg: Leg, load: float):
        super().__init__(leg)
        self.load = load

    def begin(self) -> None:
        self.passed: dict[float, FloatArray] = {}  #: (dof,) displacements since the start at the ends of increments
        self.singly_until = self.leg.start.load_factor

    def step(self, point: Point, stuck: bool) -> Point:
        leg = self.leg
        if leg.direction * (point.factor - self.singly_until) < 0.0:
            return super().step(point, stuck)
        ahead = [factor for factor in leg.guide if leg.direction * (factor - point.factor) > 0.0]
        new = ahead[:2][-1] if ahead else leg.towards(point.factor, self.load / leg.unit)
        found = leg.increased(point, new)
        if found is None:
            self.singly_until = new
            return super().step(point, stuck)
        q = found.configuration.q
        self.passed[new] = point.section.origin + q
        leg.record.events += events.changes(replace(point, factor=new), found.sense)
        velocity = (q - point.known.q) / abs(new - point.factor)
        return relisted(
            leg, replace(point, factor=new, trial=found, sense=found.sense, due=found.sense, velocity=velocity)
        )

    def rates_from(self, point: Point) -> Rates | None:
        return None


def load_together(leg: Leg, point: Point, asked: float | None) -> float | None:
    """Load (mean weights) within which events are taken together; None where none are."""
    load = asked or None
    if asked is None and point.section.system.pattern.dissected:
        load = min(OPTIONS.together * leg.problem.n**0.5, OPTIONS.longest)
    # in two increments at least, or there are none of twice the length
    return None if load is None else min(load, 0.5 * leg.unit * abs(leg.target - leg.start.load_factor))


def followed_together(leg: Leg, point: Point, load: float) -> State:
    """The state at the target, and what increments leave out: its difference from that of increments twice as long.

    The guesses of these are what the shorter ones found.
    """
    way = Together(leg, load)
    state = followed(leg, point, way)
    whole = leg.unit * abs(leg.target - leg.start.load_factor)
    if whole == 0.0:
        return state
    leg.guide, error = way.passed, np.inf
    with suppress(SolveError):
        coarse = followed(leg, leg.at(leg.start), Together(leg, 2.0 * load))
        if coarse.walls.same_candidates(state.walls):
            error = float(np.abs(state.wall_force() - coarse.wall_force()).max(initial=0.0)) / whole
    leg.record.events[leg.begun :] = state.reached.events
    work = leg.record.work
    reached = replace(
        state.reached, increments=work.increments, factorisations=work.factorisations, events_within=load,
        events_error=error,
    )  # fmt: skip
    return replace(state, reached=reached)
