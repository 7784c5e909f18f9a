"""A packing as arrays: where the disks are before gravity acts, and how large they are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..state import Box, FloatArray

if TYPE_CHECKING:
    from .contacts import GivenContact

IntArray = NDArray[np.int32]


def exact_mean(values: FloatArray) -> float:
    """Mean with one rounding only, so that it is the same on every machine."""
    largest = float(np.abs(values).max())
    scale = largest if largest > 1e300 else 1.0  # a sum of these may overflow
    return math.fsum(np.asarray(values) / scale) / len(values) * scale


def generator(seed: int, realization: int) -> np.random.Generator:
    """Random numbers of one packing of an ensemble, the same ones each time."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(realization,)))


@dataclass(frozen=True, eq=False, repr=False)
class Packing:
    """n disks before the preparation, in reduced units; the arrays are never modified.

    The floor is ``z = 0``, the side walls are ``x = 0`` and ``x = width``. Lattices are numbered row by
    row from the bottom, left to right; ``left`` says so, and is what neighbours and rows follow from.
    """

    position: FloatArray  #: (n, 2) centres x, z
    radius: FloatArray  #: (n,) with mean 1
    row: IntArray  #: (n,) row in the lattice, 0 at the bottom; -1 for a packing from a file
    width: float  #: distance of the side walls, or period
    #: (rows,) left end of each row of a lattice, in half lattice constants; None for disks that are numbered anyhow
    left: NDArray[np.int64] | None = None
    lattice_constant: float | None = None  #: distance of neighbours in the lattice; None from a file
    periodic: bool = False  #: periodic sides in place of walls
    given_mass: FloatArray | None = None  #: (n,) with mean 1, where disks are not of one material
    columns: Mapping[str, FloatArray] | None = None  #: (n,) each, of its file beside places and sizes, as they stand
    given: FloatArray | None = None  #: (n, 2) where a user's own disks were given; None for packings that are made
    contacts: Sequence[GivenContact] | None = None  #: that a user's own disks begin with; None: without springs
    frame: str = ""  #: which frame of its file this is, such as "3 of 3, time step 200", where the format has frames

    @property
    def n(self) -> int:
        return len(self.radius)

    def __repr__(self) -> str:
        low, high = self.radius.min(), self.radius.max()
        return f"Packing({self.n} disks, radii from {low:.4g} to {high:.4g}, box {self.width:g} wide)"

    @property
    def box(self) -> Box:
        return Box(self.width, self.periodic)

    @property
    def middle(self) -> float:
        """The x nearest to which a load on top is: half-way between the walls, or the middle disk of the top row.

        With periodic sides that is disk ``row_count[-1] // 2`` of the row.
        """
        if not self.periodic or self.left is None:
            return 0.5 * self.width
        count = self.row_count
        return float(self.position[self.n - count[-1] + count[-1] // 2, 0])

    @property
    def ordered(self) -> bool:
        """Whether this is a lattice of equal disks."""
        return self.left is not None and bool(self.radius.max() == self.radius.min())

    def moved(self, position: FloatArray) -> FloatArray | None:
        """(n,) distance of disks at ``position`` (n, 2) from where they were given; None where they were not."""
        if self.given is None:
            return None
        return np.linalg.norm(self.box.separation(position, self.given), axis=1)

    @cached_property
    def mass(self) -> FloatArray:
        """(n,) masses, radius^2 over its mean unless they are given: one material, mean mass 1 (Sec. III.B)."""
        if self.given_mass is not None:
            return self.given_mass
        squared = self.radius**2
        return squared / exact_mean(squared)

    @cached_property
    def inertia(self) -> FloatArray:
        """(n,) moments of inertia of homogeneous disks, m r^2 / 2 (Sec. III.B)."""
        return 0.5 * self.mass * self.radius**2

    @cached_property
    def row_count(self) -> NDArray[np.int64]:
        """(rows,) number of disks in each row from the bottom; empty without a lattice."""
        return np.zeros(0, dtype=np.int64) if self.left is None else np.bincount(self.row)

    def neighbour_pairs(self) -> IntArray | None:
        """(m, 2) neighbours i < j in the lattice, ordered by i and then j; None without a lattice.

        For each disk its neighbours to the right, up left and up right, across periodic sides too. Found from the row
        and the place in it alone, so neither polydispersity nor rounding changes them.
        """
        return self._neighbours

    @cached_property
    def _neighbours(self) -> IntArray | None:
        if self.left is None:
            return None
        count = self.row_count
        start = np.concatenate([[0], np.cumsum(count)[:-1]])
        column = np.arange(self.n) - start[self.row]
        length = count[self.row]
        found = [(self.periodic | (column + 1 < length), start[self.row] + (column + 1) % length)]
        above = np.minimum(self.row + 1, len(count) - 1)
        for side in (-1, 1):  # in half lattice constants the upper neighbours of h are at h - 1 and h + 1
            upper = (self.left[self.row] + 2 * column + side - self.left[above]) // 2
            exists = (above > self.row) & (self.periodic | ((upper >= 0) & (upper < count[above])))
            found.append((exists, start[above] + upper % count[above]))
        pairs = [np.stack([np.flatnonzero(exists), other[exists]], axis=1) for exists, other in found]
        result = np.sort(np.concatenate(pairs), axis=1)
        return np.ascontiguousarray(result[np.lexsort((result[:, 1], result[:, 0]))], dtype=np.int32)
