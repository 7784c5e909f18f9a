"""Slabs and piles: disks on a triangular lattice (Sec. III.C and V.F)."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from .base import Fraction, Index, PackingDescription, Sides, allowed
from .errors import must
from .packing import Packing, exact_mean, generator

TOUCHING_LARGEST = "touching-largest"
MOST_DISKS = 100_000_000

Rows = Annotated[int, Field(strict=True, ge=1, le=100_000), allowed("must be a whole number from 1 to 100000")]
RowLength = Annotated[int, Field(strict=True, ge=2, le=100_000), allowed("must be a whole number from 2 to 100000")]
LatticeConstant = Annotated[
    Annotated[float, Field(strict=True, gt=0, le=1000)] | Literal["touching-largest"],
    allowed(f"must be a number greater than 0, at most 1000, or {TOUCHING_LARGEST}"),
]
#: Disks per row of the narrowest periodic slab.
LEAST_PERIOD = 5


def touching_largest(polydispersity: float) -> float:
    """Lattice constant at which two of the largest disks just touch: twice their radius, with a mean radius of 1."""
    return 2.0 / (1.0 - 0.5 * polydispersity)


class LatticePacking(PackingDescription):
    """What slab and pile share: a triangular lattice, and radii drawn from one interval."""

    kind: str
    layers: Rows
    polydispersity: Fraction = Field(
        default=0.0, description="delta: radii are drawn uniformly from [(1 - delta) R, R] and rescaled to a mean of 1."
    )
    lattice_constant: LatticeConstant = Field(
        default=2.0,
        description="Distance of neighbouring centres in the initial lattice. 2 is the paper's: with polydispersity "
        "large disks overlap at first and push each other away. touching-largest is 2 / (1 - delta / 2), where two of "
        "the largest disks just touch. Floor and side walls are half of it from the nearest centres.",
    )
    seed: Index = Field(default=0, description="Seed of the random radii.")
    realization: Index = Field(
        default=0,
        description="Number of the packing within an ensemble. Seed and realization fix the random numbers for every "
        "polydispersity.",
    )

    def row_count(self) -> NDArray[np.int64]:
        """(rows,) number of disks in each row, from the bottom."""
        raise NotImplementedError

    def _left(self) -> NDArray[np.int64]:
        """(rows,) left end of each row, in half lattice constants from the left end of the first."""
        raise NotImplementedError

    @property
    def disk_count(self) -> int:
        return int(self.row_count().sum())

    @model_validator(mode="after")
    def _check_size(self) -> LatticePacking:
        n, rule = self.disk_count, f"must have at most {MOST_DISKS} disks"
        must(n <= MOST_DISKS, rule, key=("layers",), value=f"{n} disks")
        return self

    def build(self) -> Packing:
        """Lattice positions and random radii."""
        count, left = self.row_count(), self._left()
        row = np.repeat(np.arange(len(count)), count)
        column = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        radius = 1.0 - self.polydispersity * generator(self.seed, self.realization).random(len(row))
        given = self.lattice_constant
        a = touching_largest(self.polydispersity) if isinstance(given, str) else given
        x = 0.5 * a * (1 + left[row] + 2 * column)
        z = 0.5 * a + row * (0.5 * math.sqrt(3.0) * a)
        return Packing(
            position=np.stack([x, z], axis=1),
            radius=radius / exact_mean(radius),
            row=row.astype(np.int32),
            width=float(count[0] * a),
            left=left,
            lattice_constant=float(a),
            periodic=self.periodic,
        )


class SlabPacking(LatticePacking):
    """A slab between two side walls; rows of n and n - 1 disks alternate, a long one at the bottom.

    With periodic sides all rows have n disks, and every second one is shifted by half a lattice constant.

    Examples
    --------
    >>> gr.Slab(layers=4, disks_per_row=9).disk_count
    34
    """

    kind: Literal["slab"] = Field(
        default="slab", description="Rows on a triangular lattice between side walls, or with periodic sides."
    )
    layers: Rows = Field(default=15, description="Number of rows.")
    disks_per_row: RowLength = Field(
        default=61,
        description="Disks in the bottom row and every second one above; the others have one less, and as many with "
        "periodic sides.",
    )
    sides: Sides = "walls"

    @model_validator(mode="after")
    def _check_period(self) -> SlabPacking:
        rule = f"must be at least {LEAST_PERIOD} with periodic sides, so that no disk meets another on both sides"
        enough = self.disks_per_row >= LEAST_PERIOD or not self.periodic
        must(enough, rule, key=("disks_per_row",), value=self.disks_per_row)
        return self

    def row_count(self) -> NDArray[np.int64]:
        if self.periodic:
            return np.full(self.layers, self.disks_per_row)
        return self.disks_per_row - np.arange(self.layers) % 2

    def _left(self) -> NDArray[np.int64]:
        return np.arange(self.layers) % 2


class PilePacking(LatticePacking):
    """A pile with sides at 30 degrees: each row has three disks less than the one below, the top one has one.

    The side walls are tangent to the bottom row, which they keep from spreading (Sec. V.F).

    Examples
    --------
    >>> gr.Pile(layers=5).build()
    Packing(35 disks, radii from 1 to 1, box 26 wide)
    """

    kind: Literal["pile"] = Field(default="pile", description="A triangular heap with sides at 30 degrees.")
    layers: Rows = Field(default=11, description="Number of rows; the bottom one has 3 layers - 2 disks.")

    def row_count(self) -> NDArray[np.int64]:
        return 1 + 3 * np.arange(self.layers - 1, -1, -1)

    def _left(self) -> NDArray[np.int64]:
        return 3 * np.arange(self.layers)
