"""A packing as arrays: where the disks are before gravity acts, and how large they are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]


def exact_mean(values: FloatArray) -> float:
    """Mean with one rounding only, so that it is the same on every machine."""
    return math.fsum(values) / len(values)


@dataclass(frozen=True, eq=False)
class Packing:
    """n disks before the preparation, in reduced units; the arrays are never modified.

    The floor is ``z = 0``, the side walls are ``x = 0`` and ``x = width``. Lattices are numbered row by
    row from the bottom, left to right.
    """

    position: FloatArray  #: (n, 2) centres x, z
    radius: FloatArray  #: (n,) with mean 1
    row: IntArray  #: (n,) row in the lattice, 0 at the bottom; -1 for a packing from a file
    width: float  #: distance of the side walls
    kind: str  #: slab, pile or file
    lattice_constant: float | None = None  #: distance of neighbours in the lattice; None from a file

    @property
    def n(self) -> int:
        """Number of disks."""
        return len(self.radius)

    @property
    def ordered(self) -> bool:
        """Whether this is a lattice of equal disks."""
        return self.kind != "file" and bool(self.radius.max() == self.radius.min())

    @cached_property
    def mass(self) -> FloatArray:
        """(n,) masses, radius^2 over its mean: disks of one material, mean mass 1 (Sec. III.B)."""
        squared = self.radius**2
        return squared / exact_mean(squared)

    @cached_property
    def inertia(self) -> FloatArray:
        """(n,) moments of inertia of homogeneous disks, m r^2 / 2 (Sec. III.B)."""
        return 0.5 * self.mass * self.radius**2

    @cached_property
    def row_count(self) -> NDArray[np.int64]:
        """(rows,) number of disks in each row from the bottom; empty for a packing from a file."""
        return np.bincount(self.row) if self.kind != "file" else np.zeros(0, dtype=np.int64)

    def neighbour_pairs(self) -> IntArray | None:
        """(m, 2) neighbours i < j in the lattice, ordered by i and then j; None from a file.

        For each disk its neighbours to the right, up left and up right. Found from the row and the place in
        it alone, so neither polydispersity nor rounding changes them.
        """
        if self.kind == "file":
            return None
        count = self.row_count
        start = np.concatenate([[0], np.cumsum(count)[:-1]])
        column = np.arange(self.n) - start[self.row]
        # Left end of each row in half lattice constants; the upper neighbours of h are at h - 1 and h + 1.
        rows = np.arange(len(count))
        left = rows % 2 if self.kind == "slab" else 3 * rows
        has_right = column + 1 < count[self.row]
        pairs = [_pairs(has_right, np.arange(self.n) + 1)]
        above = np.minimum(self.row + 1, len(count) - 1)
        for side in (-1, 1):
            upper = (left[self.row] + 2 * column + side - left[above]) // 2
            exists = (above > self.row) & (upper >= 0) & (upper < count[above])
            pairs.append(_pairs(exists, start[above] + upper))
        result = np.concatenate(pairs)
        return np.ascontiguousarray(result[np.lexsort((result[:, 1], result[:, 0]))], dtype=np.int32)

    def may_rearrange(
        self, normal_stiffness: float, *, wall_stiffness: float | None = None, damping_ratio: float = 0.5
    ) -> bool:
        """Whether disks that are not neighbours in the lattice could touch while gravity is brought on.

        False says that ``neighbour_pairs`` are all contacts between disks during the preparation; a load can
        still bring others. True promises nothing. The answer is True if this sum of three lengths reaches a
        limit:

        * lift: how high the energy ``k/2 overlap^2`` of the largest initial overlap of two disks, or of a disk
          and a wall, could throw a disk of mean weight;
        * slack: the most room that is left in one row, since its disks could leave all of it in one place;
        * softness: compressed by its weight, a tall or wide lattice buckles as a whole. In simulations it did
          so from about ``0.5 = layers / k sqrt(disks_per_row + 2 layers)`` in slabs and ``3 = layers^3 / k`` in
          piles. Softness is 3 times the one, 0.15 times the other, so that it reaches the limit at half of that.

        The limit in a slab is ``sqrt(3) - 1``, half of the gap to second neighbours: one of the two has to move
        so far. In a pile, whose sides are free, it is ``2 - sqrt(3)``, the height over which a disk rolls out of
        its place. The dashpots take up what a disk would pass on to others, so with a damping ratio below 0.1
        the answer is True. So it is for files.

        Measured without friction on random slabs and piles: in all 435 with the answer False, second neighbours
        kept at least 0.88 of their gap; of 66 with the answer True they touched in 26.

        Parameters
        ----------
        normal_stiffness, wall_stiffness
            Stiffness of contacts between disks and with walls (by default twice the former).
        damping_ratio
            Damping over critical damping of one contact.
        """
        pairs = self.neighbour_pairs()
        if pairs is None or self.lattice_constant is None or damping_ratio < 0.1:
            return True
        spacing, diameter = self.lattice_constant, 2.0 * self.radius
        wall_stiffness = 2.0 * normal_stiffness if wall_stiffness is None else wall_stiffness
        overlap = float((self.radius[pairs].sum(axis=1) - spacing).max(initial=0.0))
        wall_overlap = max(0.0, 0.5 * float(diameter.max() - spacing))
        lift = 0.5 * max(normal_stiffness * overlap**2, wall_stiffness * wall_overlap**2)
        room = self.row_count * spacing - np.bincount(self.row, weights=diameter)
        layers, length = len(self.row_count), int(self.row_count[0])
        if self.kind == "slab":
            limit = math.sqrt(3.0) - 1.0
            softness = 3.0 * layers / normal_stiffness * math.sqrt(length + 2 * layers)
        else:
            limit = 2.0 - math.sqrt(3.0)
            softness = 0.15 * layers**3 / normal_stiffness
        return bool(lift + max(0.0, float(room.max())) + softness >= limit)


def _pairs(exists: NDArray[np.bool_], other: NDArray[np.int64]) -> NDArray[np.int64]:
    first = np.flatnonzero(exists)
    return np.stack([first, other[first]], axis=1)
