"""Events of a path: what contacts do between two points, and the loss of an equilibrium."""

from __future__ import annotations

import numpy as np

from ...state import OPEN, ROW_EVENTS, SLIDING, STICKING, Event, FloatArray
from .points import Point


def changes(point: Point, after: np.ndarray, until: float | None = None) -> list[Event]:
    """The events in which contacts get the signed statuses ``after`` (m + w,), at the latest ``until``."""
    changed = (point.sense != after).nonzero()[0]
    if not changed.size:
        return []
    system, packing, moved = point.system, point.system.problem.packing, point.moved
    m, until = len(system.first), point.factor if until is None else until
    count = m + len(system.wall_disk)
    c = changed % count
    at_wall, first = c >= m, np.concatenate([system.first, system.wall_disk])[c]
    second, here = np.concatenate([system.second, system.wall])[c], system.reference[first] + moved[first]
    other = np.where(at_wall, first, second)
    towards = packing.box.separation(system.reference[other] + moved[other], here)
    towards[at_wall] = -system.wall_normals[c[at_wall] - m]
    places = here + towards * (packing.radius[first] / np.hypot(*towards.T))[:, None]
    columns = changed, point.sense[changed], after[changed], first, second, at_wall, places
    return [
        Event(point.factor, kind, i, j, wall, x, z, until)
        for k, before, now, i, j, wall, (x, z) in zip(*(column.tolist() for column in columns), strict=True)
        for kind in _kinds(before, now, row=k // count)
    ]


def lost(kind: str, factor: float, until: float, position: FloatArray, moved: FloatArray, reason: str) -> Event:
    """The loss of an equilibrium, after which disks at ``position`` (n, 2) have moved by ``moved`` (n, 2)."""
    far = np.hypot(*moved.T)
    i = int(np.argmax(far))
    x, z = position[i]
    return Event(factor, kind, i, x=float(x), z=float(z), until=until, displacement=float(far[i]), reason=reason)


def side(moved: FloatArray) -> str:
    """To which side displacements (n, 2) lead, taken together: right or left."""
    return "right" if float(moved[:, 0].sum()) >= 0.0 else "left"


def _kinds(before: int, after: int, *, row: int) -> tuple[str, ...]:
    """What a contact does between two signed statuses of a row; only the first says that it opens or closes."""
    slides, sticks, reverses = ROW_EVENTS[row]
    if OPEN not in (before, after):
        return (sticks if after == STICKING else reverses if abs(before) == SLIDING else slides,)
    if row > 0:
        return ()
    return ("opens",) if after == OPEN else ("closes", slides) if abs(after) == SLIDING else ("closes",)
