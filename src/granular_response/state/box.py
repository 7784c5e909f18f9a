"""The box: what bounds a packing, and the one place that knows distances and normals at its boundaries.

The floor is ``z = 0``. At the sides there are walls at ``x = 0`` and ``x = width``, or nothing: periodic sides
identify ``x`` and ``x + width``. Lengths are in mean disk radii. Solvers work with the differences and gaps that
are made here, from positions that are never wrapped.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FLOOR, LEFT_WALL, RIGHT_WALL = 0, 1, 2
#: Their names, in order.
WALL_MEANINGS = ("floor", "left_wall", "right_wall")
#: Widest box and farthest place of a disk (mean radii): beyond it an overlap is lost in the rounding of a position.
FARTHEST = 1e9
#: (3, 2) inward unit normals of the floor, the left and the right wall.
WALL_NORMAL = np.array([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]])


def wall_normals(wall) -> FloatArray:
    """(w, 2) inward normals of the given walls."""
    return np.ascontiguousarray(WALL_NORMAL[np.asarray(wall, np.int64)])


def foot_points(position, radius, wall) -> FloatArray:
    """(w, 2) points of disks (centres ``position`` (w, 2), ``radius`` (w,)) that are nearest to their walls."""
    return np.asarray(position) - np.asarray(radius)[:, None] * wall_normals(wall)


def bodies(first: int, second: int, at_wall: bool) -> str:
    """The two sides of a contact for people: "disks 3 and 1", or "disk 3 and the left wall"."""
    if at_wall:
        return f"disk {first} and the {WALL_MEANINGS[second].replace('_', ' ')}"
    return f"disks {first} and {second}"


@dataclass(frozen=True)
class Box:
    """Floor and sides of a packing."""

    width: float  #: distance of the side walls, or period
    periodic: bool = False  #: periodic sides in place of walls

    @classmethod
    def of(cls, attributes: Mapping[Any, Any]) -> Box:
        """The box that the attributes ``width`` and ``sides`` of a stored result describe."""
        return cls(float(attributes["width"]), attributes.get("sides") == "periodic")

    @property
    def period(self) -> float | None:
        """Period of x; None between walls."""
        return self.width if self.periodic else None

    @property
    def walls(self) -> tuple[int, ...]:
        return (FLOOR,) if self.periodic else (FLOOR, LEFT_WALL, RIGHT_WALL)

    def separation(self, a, b) -> FloatArray:
        """(..., 2) from points ``b`` to points ``a``: the shortest way, across a periodic side too."""
        d = np.asarray(a) - np.asarray(b)
        if self.periodic:
            d[..., 0] -= self.width * np.round(d[..., 0] / self.width)
        return d

    def wall_gap(self, position, radius, wall) -> FloatArray:
        """(w,) gaps between disks (centres (w, 2)) and the given ``wall`` (w,) of each; negative is an overlap."""
        x, z = position[:, 0], position[:, 1]
        distance = np.where(wall == FLOOR, z, np.where(wall == LEFT_WALL, x, self.width - x))
        return distance - radius

    def on_wall(self, position, wall) -> FloatArray:
        """(w, 2) points of the walls that are nearest to points ``position`` (w, 2)."""
        point = np.array(position, float)
        wall = np.asarray(wall)
        point[wall == FLOOR, 1] = 0.0
        point[wall == LEFT_WALL, 0] = 0.0
        point[wall == RIGHT_WALL, 0] = self.width
        return point

    def near_walls(self, position, radius, margin: float) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
        """Disks with a gap below ``margin`` to a wall, and that wall: wall by wall, in the order of disks."""
        disks = [np.flatnonzero(self.wall_gap(position, radius, np.array(wall)) < margin) for wall in self.walls]
        walls = np.repeat(np.array(self.walls, np.int8), [len(near) for near in disks])
        return np.concatenate(disks).astype(np.int64), walls
