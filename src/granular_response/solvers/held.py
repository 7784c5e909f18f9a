"""Displacement-controlled loads: coordinates of disks that the load factor gives, and the forces that hold them there.

A held coordinate is no unknown. Statics keeps its place among the others, with no force out of balance and a unit row
and column in the tangent; dynamics gives it no acceleration. What holds it, the reaction, is what its contacts, its
weight and the other loads leave out of balance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene import Load, SceneError
from ..state import FloatArray


@dataclass(frozen=True)
class Held:
    """h coordinates of disks that loads move."""

    load: NDArray[np.int64]  #: (h,) which load
    disk: NDArray[np.int64]  #: (h,)
    axis: NDArray[np.int64]  #: (h,) 0 for x, 1 for z
    origin: FloatArray  #: (h,) coordinate at rest, load factor 0
    travel: FloatArray  #: (h,) displacement at load factor 1

    @classmethod
    def by(cls, loads: tuple[Load, ...], disk: NDArray[np.int64], position: FloatArray) -> Held:
        """What the ``loads`` on the disks ``disk`` (l,) hold, displaced from the rest ``position`` (n, 2).

        Raises
        ------
        SceneError
            When two loads hold one coordinate of one disk.
        """
        found = [
            (k, int(disk[k]), axis, travel)
            for k, load in enumerate(loads)
            for axis, travel in enumerate(load.displacement or ())
            if travel is not None
        ]
        seen: dict[tuple[int, int], int] = {}
        for k, i, axis, _ in found:
            first = seen.setdefault((i, axis), k)
            if first != k:
                raise SceneError(
                    f"loads[{k}].displacement: moves disk {i} along {'xz'[axis]}, and so does loads[{first}]; "
                    "must be null there in one of them"
                )
        load, disks, axes = (np.array([one[part] for one in found], np.int64) for part in range(3))
        travels = np.array([one[3] for one in found], float)
        return cls(load, disks, axes, np.asarray(position, float)[disks, axes], travels)

    def __len__(self) -> int:
        return len(self.disk)

    def unknowns(self, n: int) -> NDArray[np.int64]:
        """(h,) places among the unknowns ``[x | z | angle]`` of n disks."""
        return self.axis * n + self.disk

    def shift(self, reference: FloatArray, load_factor: float) -> FloatArray:
        """(h,) displacements from ``reference`` (n, 2) at a load factor."""
        return (self.origin - reference[self.disk, self.axis]) + load_factor * self.travel


#: Nothing is held.
NOTHING = Held.by((), np.zeros(0, np.int64), np.zeros((0, 2)))
