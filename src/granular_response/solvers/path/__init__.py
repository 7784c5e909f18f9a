"""Quasi-static loading: from one contact event to the next (the limit of infinitely slow ramps).

Between two events no contact changes its status, so the equations of equilibrium are smooth and their solution under
any increment of the load is exact. The path goes (Oron and Herrmann, Phys. Rev. E 58, 2079, 1998, do the same for
frictionless arrays):

1. :class:`..rates.RateProblem` gives the statuses with which the equilibrium goes on, and the rates of displacements;
2. the load at which the next contact changes follows from the rates; Newton's method with the statuses as they are
   finds equilibrium there, and by the way the load at which the change is exact to ``PathOptions.event``; where the
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
from dataclasses import replace

import numpy as np

from ...state import State
from ..increment import Work
from ..problem import Problem
from .events import lost
from .points import OPTIONS, Collapsed, Leg, PathError, PathOptions, PathRecord
from .singly import Singly, followed
from .together import followed_together, load_together

__all__ = ["OPTIONS", "Collapsed", "PathError", "PathOptions", "PathRecord", "follow", "lost"]


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
    record = record or PathRecord(Work(start.reached.increments or 0, start.reached.factorisations or 0))
    states = [start]
    for factor in map(float, factors):
        states.append(_to(Leg(problem, record, states[-1], factor, lowest, progress), together))
    return states[1:]


def _to(leg: Leg, asked: float | None) -> State:
    """The state at the end of a leg."""
    start = leg.start
    if leg.target == start.load_factor and start.reached.certificate is not None and start.certificate.stable:
        return replace(start, reached=replace(start.reached, events=()))
    point = leg.at(start)
    load = load_together(leg, point, asked)
    return followed(leg, point, Singly(leg)) if load is None else followed_together(leg, point, load)
