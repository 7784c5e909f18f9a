"""The driver of a path: from one change of contacts to the next, up to the load that is asked for."""

from __future__ import annotations

from dataclasses import replace

from ...state import State
from ..dynamics import DynamicsError
from ..rates import Rates
from . import events
from .landing import landed
from .losses import beyond, by_motion, diverges, first_unstable, relisted
from .points import OPTIONS, Leg, PathError, Point


class Singly:
    """Steps from one change of contacts to the next."""

    def __init__(self, leg: Leg):
        self.leg = leg

    def begin(self) -> None:
        """The leg begins, perhaps anew."""

    def step(self, point: Point, stuck: bool) -> Point:
        """The next point: where a contact changes, the target, or beyond an equilibrium that is lost.

        ``stuck`` : whether contacts have changed again and again at one load.
        """
        leg = self.leg
        rates = None if stuck else self.rates_from(point)
        if rates is None:
            return relisted(leg, beyond(leg, point, "no statuses of the contacts go on"))
        leg.record.events += events.changes(point, rates.sense)
        negative, before = rates.factor.negative_pivots, point.negative
        point = replace(point, velocity=rates.velocity, negative=negative)
        # one real eigenvalue is negative, or real ones have passed zero; where contacts slide these may not go along
        if negative % 2 or negative not in (0, before):
            near = point.unstable if negative == before else None
            direction, unstable = diverges(point, point.trial, rates.sense, near)
            if direction is not None:
                return by_motion(leg, point, "bifurcation", "unstable", direction)
            point = replace(point, unstable=unstable)
        found = landed(leg, point, rates)
        if found is None:
            return relisted(leg, beyond(leg, point, "no equilibrium with these statuses"))
        leg.record.work.increments += 1
        if abs(found.factor - point.factor) * leg.unit > point.section.rates.force:
            leg.goes_on()
        return relisted(leg, found)

    def rates_from(self, point: Point) -> Rates | None:
        """The rates by which a step goes on from a point; None where it does by the return map."""
        return point.section.rates.solve(point.trial, point.due)


def followed(leg: Leg, point: Point, way: Singly, watched: bool = False) -> State:
    """The certified state at the target, from ``point``, where the leg starts.

    ``watched`` : whether stability is looked at wherever a contact changes, with a factorisation each; needed only
    where the equilibrium at the target turns out to be unstable.
    """
    recorded = leg.record.events
    del recorded[leg.begun :]
    way.begin()
    point = leg.balanced(point)
    returned = 0  #: times that the equilibrium at the target was unstable
    while True:
        still = 0  #: points in turn at one load
        while point.factor != leg.target:
            before, known = point, len(recorded)
            point = way.step(before, still > OPTIONS.still)
            if watched and not any(event.lost for event in recorded[known:]):
                point = first_unstable(leg, before, point, way.rates_from)
            gone = abs(point.factor - before.factor) * leg.unit
            still = still + 1 if gone < point.section.rates.force else 0
            leg.look_down(point.factor, point)
            if leg.progress is not None and leg.direction * (point.factor - leg.reported) > 0.0:
                leg.reported = point.factor
                leg.progress(point.factor)
        state = leg.kept(point)
        if state.certificate.stable is not False:
            return replace(state, reached=replace(state.reached, events=tuple(recorded[leg.begun :])))
        if not watched:
            return followed(leg, leg.at(leg.start), way, watched=True)
        returned += 1
        if returned > OPTIONS.still:
            raise PathError(f"the equilibrium at load factor {leg.target:g} is unstable, and motion returns to it")
        try:
            point = by_motion(leg, point, "bifurcation", "unstable", None)
        except (DynamicsError, PathError):  # motion hardly leaves it, and finds nothing beside it
            point = leg.at(state)
            direction, _ = diverges(point, point.trial, point.sense)
            if direction is None:
                raise
            point = by_motion(leg, point, "bifurcation", "unstable", direction)
