"""Quasi-static loading: from one contact event to the next (the limit of infinitely slow ramps).

Between two events no contact changes its status, so the equations of equilibrium are smooth and their solution under
any increment of the load is exact. The path goes (Oron and Herrmann, Phys. Rev. E 58, 2079, 1998, do the same for
frictionless arrays):

1. :class:`..rates.RateProblem` gives the statuses with which the equilibrium goes on, and the rates of displacements;
2. the load at which the next contact changes follows from the rates; Newton's method with the statuses as they are
   finds equilibrium there, and by the way the load at which the change is exact to ``SystemOptions.event``; where the
   return map would give another force than a status that was kept, the rates at the end tell what changed on the way,
   and slip that turned round is bracketed;
3. contacts that are at their change change, a mirror pair together, and so on from 1.

An equilibrium is lost where the rates have no solution, where there is no equilibrium a little further with these
statuses (a snap-through), or where the tangent has an unstable direction along which the contacts that slide go on
sliding (divergence; at a bifurcation of a symmetric branch). The next one is looked for nearby under a slightly larger
load, with the limits of friction held fixed (:mod:`..increment`); where there is none the motion of the disks leads to
it (:mod:`..settle`). All are events of the result.

In packings too large for a banded factorisation events are taken together within an increment of the load; what that
leaves out is estimated by a path in increments of twice the length: no bound, since both may miss the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from ...errors import SolveError
from ...state import State
from ..dynamics import DynamicsError
from ..problem import Problem
from ..system import OPTIONS as SYSTEM
from . import events
from .landing import landed
from .losses import beyond, by_motion, diverges, first_unstable, relisted
from .points import OPTIONS, Collapsed, Leg, PathError, PathRecord, Point
from .together import Together

__all__ = ["OPTIONS", "Collapsed", "PathError", "PathRecord", "follow"]


def follow(
    problem: Problem,
    start: State,
    factors: Sequence[float],
    *,
    together: float | None = None,
    lowest: float = -np.inf,
    progress: Callable[[float], None] | None = None,
    record: PathRecord | None = None,
) -> list[State]:
    """States at the load ``factors`` in turn, growing or falling, reached through every load between.

    Parameters
    ----------
    problem : with its loads chosen.
    start : certified state; a path may start from any of the states it returned, also from a file, and then goes on to
        the last bit as if it had not been cut.
    factors : multipliers of the loads, in turn.
    together : load (mean weights) within which events are taken together, with the return map of whole increments;
        by default none, but in large packings.
    lowest : height below which the first loaded disk must not sink.
    record : what the path costs, and its events; by default goes on from what ``start`` has cost.

    Raises
    ------
    Collapsed
        When the first loaded disk sinks below ``lowest``.
    DynamicsError
        When the motion from a lost equilibrium blows up, or the load carries a disk off.
    PathError
        When the motion does not settle either: the packing collapses or cycles under this load.
    """
    record = record or PathRecord(start.reached.increments or 0, start.reached.factorisations or 0)
    states = [start]
    for factor in map(float, factors):
        states.append(_to(Leg(problem, record, states[-1], factor, lowest, progress, OPTIONS), together))
    return states[1:]


def _to(leg: Leg, asked: float | None) -> State:
    """The state at the end of a leg."""
    start = leg.start
    if leg.target == start.load_factor and start.reached.certificate is not None and start.certificate.stable:
        return replace(start, reached=replace(start.reached, events=()))
    point, coarse = leg.at(start), None
    together = Together.asked(leg, point, asked)
    state = followed(leg, point, together)
    if together is None:
        return state
    with suppress(SolveError):
        coarse = followed(leg, leg.at(start), together.coarser())
    return together.judged(state, coarse)


def followed(leg: Leg, point: Point, together: Together | None, watched: bool = False) -> State:
    """The certified state at the target, from ``point``, where the leg starts.

    ``watched`` : whether stability is looked at wherever a contact changes, with a factorisation each; needed only
    where the equilibrium at the target turns out to be unstable.
    """
    recorded = leg.record.events
    del recorded[leg.begun :]
    if together is not None:
        together.begin()
    point = leg.balanced(point)
    returned = 0  #: times that the equilibrium at the target was unstable
    while True:
        still = 0  #: points in turn at one load
        while point.factor != leg.target:
            before, known = point, len(recorded)
            increment = None if together is None else together.step(point)
            point = step(leg, point, still > SYSTEM.patience) if increment is None else increment
            if watched and not any(event.lost for event in recorded[known:]):
                point = first_unstable(leg, before, point, one_by_one=together is None)
            gone = abs(point.factor - before.factor) * leg.unit
            still = still + 1 if gone < point.rate_problem.force else 0
            leg.look_down(point.factor, point)
            if leg.progress is not None and leg.direction * (point.factor - leg.reported) > 0.0:
                leg.reported = point.factor
                leg.progress(point.factor)
        state = leg.kept(point)
        if state.certificate.stable is not False:
            return replace(state, reached=replace(state.reached, events=tuple(recorded[leg.begun :])))
        if not watched:
            return followed(leg, leg.at(leg.start), together, watched=True)
        returned += 1
        if returned > SYSTEM.patience:
            raise PathError(f"the equilibrium at load factor {leg.target:g} is unstable, and motion returns to it")
        try:
            point = by_motion(leg, point, "bifurcation", "unstable", None)
        except (DynamicsError, PathError):  # motion hardly leaves it, and finds nothing beside it
            point = leg.at(state)
            direction, _ = diverges(point, point.trial, point.sense)
            if direction is None:
                raise
            point = by_motion(leg, point, "bifurcation", "unstable", direction)


def step(leg: Leg, point: Point, stuck: bool) -> Point:
    """The next point: where a contact changes, the target, or beyond an equilibrium that is lost.

    ``stuck`` : whether contacts have changed again and again at one load. Where an equilibrium is lost at the target
    itself the point is kept: it is the last of its branch, and the next leg goes on from there.
    """
    rates = None if stuck else point.rate_problem.solve(point.trial, point.due)
    if rates is None:
        return leg.ended(point) or relisted(leg, beyond(leg, point, "no statuses of the contacts go on"))
    leg.record.events += events.changes(point, rates.sense)
    leg.free = leg.free or rates.free
    negative, before = rates.factor.negative_pivots, point.negative
    # one real eigenvalue is negative, or real ones have passed zero; where contacts slide these may not go along
    if negative % 2 or negative not in (0, before):
        near = point.unstable if negative == before else None
        direction, unstable = diverges(point, point.trial, rates.sense, near)
        if direction is not None:
            return leg.ended(point) or by_motion(leg, point, "bifurcation", "unstable", direction)
        point = replace(point, unstable=unstable)
    found = landed(leg, point, rates)
    if found is None:
        point = replace(point, velocity=rates.velocity, negative=negative)
        return leg.ended(point) or relisted(leg, beyond(leg, point, "no equilibrium with these statuses"))
    leg.record.increments += 1
    if abs(found.factor - point.factor) * leg.unit > point.rate_problem.force:
        leg.gone_on()
    return relisted(leg, found)
