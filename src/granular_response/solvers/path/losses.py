"""Where an equilibrium is lost: whether one diverges, and how the path goes on beyond it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...linalg.lowest import Eigenpair
from ...state import OPEN, FloatArray, State
from ..dynamics import DynamicsError, Stop
from ..settle import CROSSING, CROSSING_STOP, NotSettled, nudged, settle
from ..stability import Clustered, Spectrum, divergence, diverging
from ..system import Trial
from . import events
from .landing import smooth
from .points import Leg, PathError, Point, largest


def diverges(
    point: Point, trial: Trial, sense: np.ndarray, near: Eigenpair | None = None
) -> tuple[FloatArray | None, Eigenpair | None]:
    """(dof,) direction in which an equilibrium around a point diverges with signed statuses ``sense``, if one is found.

    And the lowest eigenvalue if it is negative; ``near`` : a negative one of the point before that may still be there.
    """
    fixed = point.system.trial(trial.configuration, trial.configuration.q, fixed=sense)
    spectrum = Spectrum(point.system, fixed, near)
    negative = spectrum.negative
    with suppress(Clustered):
        return divergence(spectrum), negative
    return None, negative


def first_unstable(leg: Leg, before: Point, point: Point, *, one_by_one: bool) -> Point:
    """``point``, if it is stable with the statuses of its increment; else the one that motion leads to.

    That begins where stability is lost after the point ``before``, from which the path has gone by rates or, where
    events are not taken one by one, by the return map; at ``point`` itself if candidates have been listed anew.
    """
    direction, unstable = diverges(point, point.trial, point.sense)
    if direction is None:
        return replace(point, unstable=unstable)
    if before.system is not point.system:
        return by_motion(leg, point, "bifurcation", "unstable", direction)
    rates = before.rate_problem.solve(before.trial, before.due) if one_by_one else None
    stable, length, last = 0.0, abs(point.factor - before.factor), before
    while (length - stable) * leg.unit > leg.options.found:
        middle = 0.5 * (stable + length)
        factor = before.factor + leg.direction * middle
        if rates is None:
            trial = leg.increased(replace(before, velocity=point.velocity), factor)
        else:
            found = smooth(leg, before, rates, middle, None)
            trial = None if found is None else found[1]
        if trial is None:
            break
        sense = trial.sense if rates is None else rates.sense
        turned, _ = diverges(point, trial, sense)
        if turned is None:
            stable, last = middle, before.on(factor, trial, sense)
        else:
            length, direction = middle, turned
    return by_motion(leg, last, "bifurcation", "unstable", direction)


def relisted(leg: Leg, point: Point) -> Point:
    """Where disks have moved so far that others may be near: candidates listed anew."""
    system, moved = point.system, largest(point.known.q[: 2 * leg.problem.n])
    if moved <= leg.options.listed_again and point.factor != leg.target:
        return point
    if system.meets_unlisted(point.known.q):
        return by_motion(leg, point, "jump", "disks meet that were not neighbours", None)
    if moved <= leg.options.listed_again:
        return point
    leg.count(system)
    new = leg.at(leg.problem.relisted(system.state(point.trial, point.factor)))
    keys, others = system.status_keys(), new.system.status_keys()
    sense, due = (carried(keys, others, status) for status in (point.sense, point.due))
    return new.on(point.factor, new.system.trial(new.known, new.known.q, fixed=sense), sense, due)


def carried(before: NDArray[np.int64], after: NDArray[np.int64], sense: np.ndarray) -> np.ndarray:
    """Signed statuses of the candidates ``before`` in the order of those ``after``; open where one is new."""
    known = dict(zip(before.tolist(), sense.tolist(), strict=True))
    return np.array([known.get(key, OPEN) for key in after.tolist()], sense.dtype)


def beyond(leg: Leg, point: Point, reason: str) -> Point:
    """The equilibrium under a load that is a little larger, if it is near; else the one that motion leads to.

    Motion alone would shake contacts off their limit where slow loading passes: in a slab of 32 disks at friction 1
    it leaves twice the distance from slow dynamics.
    """
    new = leg.towards(point.factor, leg.beyond)
    found = leg.increased(point, new)
    if found is not None:
        after = point.on(new, found)
        moved = after.moved - point.moved
        if np.abs(moved).max(initial=0.0) <= leg.options.nearby:
            leg.record.events += [events.lost("stepped over", point.factor, new, point.position, moved, reason)]
            leg.record.events += events.changes(point, found.sense, until=new)
            leg.beyond *= 2.0
            return after
    return by_motion(leg, point, "jump", reason, None)


def by_motion(leg: Leg, point: Point, kind: str, reason: str, direction: FloatArray | None) -> Point:
    """The equilibrium that the disks move to from a lost one, displaced a little along ``direction``.

    The load goes on growing as fast as the protocol says. Where the target is so near that next to nothing drives the
    motion, and it does not settle, it goes on beyond the target, as it does where that is far, and the return map leads
    back.
    """
    leg.count(point.system)
    problem, (_, here) = leg.problem, point.at_rest()
    start = here if direction is None else nudged(problem, here, direction)
    new, far = leg.towards(point.factor, leg.jump), point.factor + leg.direction * leg.jump

    def accept(state: State) -> bool:
        if state.certificate.stable is True:
            return True
        there = leg.at(state)
        return not diverging(Spectrum(there.system, there.trial))

    protocol = problem.scene.protocol

    def settled(factor: float) -> State:
        return settle(
            problem, start, CROSSING, Stop(CROSSING_STOP, maximum_steps=protocol.maximum_steps),
            what=f"load factor {factor:g}", accept=accept,
            load=(point.factor, factor, protocol.ramp_time * abs(factor - point.factor)),
            progress=lambda dynamics, _: leg.look_down(factor, dynamics),
        )  # fmt: skip

    try:
        after = replace(leg.at(settled(new)), factor=new)
    except NotSettled as error:
        back = None
        if leg.direction * (far - new) > 0.0:
            with suppress(NotSettled, DynamicsError):
                back = _back(leg, replace(leg.at(settled(far)), factor=far), new)
        if back is None:
            raise PathError(f"no equilibrium beyond load factor {point.factor:g}: {error}") from error
        after, reason = back, f"{reason}; reached from load factor {far:.9g}"
    moved = after.position - here.position
    leg.record.events.append(events.lost(kind, point.factor, new, here.position, moved, reason))
    leg.jump *= 2.0
    return after


def _back(leg: Leg, point: Point, factor: float) -> Point | None:
    """The equilibrium at a load ``factor`` that was passed, by the return map; None where that is not near."""
    found = leg.increased(replace(point, velocity=None), factor)
    if found is None:
        return None
    after = point.on(factor, found)
    near = np.abs(after.moved).max(initial=0.0) <= leg.options.nearby
    return after if near and not diverging(Spectrum(after.system, after.trial)) else None
