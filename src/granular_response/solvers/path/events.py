"""Events of a path: what contacts do between two points, and the loss of an equilibrium."""

from __future__ import annotations

import numpy as np

from ...state import OPEN, ROLLING_EVENTS, SLIDING, STICKING, Event, FloatArray
from .points import Point

#: What an event along the tangent is called along the rolling.
ROLLING = dict(zip(("slides", "sticks", "reverses"), ROLLING_EVENTS, strict=True))


def changes(point: Point, after: np.ndarray, until: float | None = None) -> list[Event]:
    """The events in which contacts get the signed statuses ``after`` (m + w,), at the latest ``until``."""
    system, found = point.system, list[Event]()
    if not len(changed := np.flatnonzero(point.sense != after)):
        return found
    m, position = len(system.first), point.position
    count, until = m + len(system.wall_disk), point.factor if until is None else until
    radius, box = system.problem.packing.radius, system.problem.packing.box
    for c in changed.tolist():
        kinds = _kinds(before := int(point.sense[c]), now := int(after[c]))
        if c >= count:
            if OPEN in (before, now):  # a contact that opens or closes does so along the rolling too
                continue
            kinds = tuple(map(ROLLING.__getitem__, kinds))
        c, at_wall = c % count, c % count >= m
        i, j = (system.wall_disk, system.wall) if at_wall else (system.first, system.second)
        first, second = int(i[c - m * at_wall]), int(j[c - m * at_wall])
        here = position[first]
        towards = -system.wall_normals[c - m] if at_wall else box.separation(position[second], here)
        x, z = here + towards * (radius[first] / np.hypot(*towards))
        found += [Event(point.factor, kind, first, second, at_wall, float(x), float(z), until) for kind in kinds]
    return found


def lost(kind: str, factor: float, until: float, position: FloatArray, moved: FloatArray, reason: str) -> Event:
    """The loss of an equilibrium, after which disks at ``position`` (n, 2) have moved by ``moved`` (n, 2)."""
    far = np.hypot(*moved.T)
    i = int(np.argmax(far))
    x, z = position[i]
    return Event(factor, kind, i, x=float(x), z=float(z), until=until, displacement=float(far[i]), reason=reason)


def _kinds(before: int, after: int) -> tuple[str, ...]:
    """What a contact does between two signed statuses."""
    if after == OPEN:
        return ("opens",)
    if before == OPEN:
        return ("closes", "slides") if abs(after) == SLIDING else ("closes",)
    if after == STICKING:
        return ("sticks",)
    return ("reverses",) if abs(before) == SLIDING else ("slides",)
