"""A disordered packing: disks of random sizes poured one after the other into a box.

Sequential deposition (Visscher and Bolsterli, Nature 239, 504 (1972)): each disk falls at a random place, rolls down
the disks below it and stays in the first hollow. Its centre keeps out of a circle around each disk that lies, with the
sum of both radii as its radius, and rolls along these circles; so disks touch and never overlap.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from ..state import FloatArray
from .base import Fraction, Index, PackingDescription, Positive, Sides, allowed
from .errors import NotAllowed, must
from .packing import Packing, exact_mean, generator

MOST_POURED = 20_000
#: Distance, in mean radii, within which a disk is where it was.
_SAME_PLACE = 1e-9

Disks = Annotated[
    int, Field(strict=True, ge=1, le=MOST_POURED), allowed(f"must be a whole number from 1 to {MOST_POURED}")
]
Numbers = Annotated[tuple[Positive, ...], Field(min_length=1), allowed("must be a list of numbers greater than 0")]


class PouredPacking(PackingDescription):
    """Disks of random sizes, poured one after the other: each rolls down to the first hollow. A disordered packing.

    Examples
    --------
    >>> packing = gr.Poured(disks=200, width=30.0, sizes=[1.0, 1.4])  # half of them 1.4 times as large
    >>> packing.build()
    Packing(200 disks, radii from 0.6841 to 1.366, box 30 wide)
    """

    kind: Literal["poured"] = Field(default="poured", description="Disks poured one after the other into a box.")
    disks: Disks = Field(default=500, description="Number of disks.")
    width: Positive = Field(default=50.0, description="Distance of the side walls, or the period.")
    sizes: Numbers = Field(default=(1.0,), description="Relative radii; each disk has one of them.")
    fractions: Numbers | None = Field(
        default=None, description="Fraction of disks with each size; null: equal fractions."
    )
    polydispersity: Fraction = Field(
        default=0.3,
        description="delta: each radius is multiplied by a random number, uniform in [1 - delta, 1], then all are "
        "rescaled to a mean of 1.",
    )
    sides: Sides = "walls"
    seed: Index = Field(default=0, description="Seed of the random radii and places.")
    realization: Index = Field(default=0, description="Number of the packing within an ensemble.")

    @model_validator(mode="after")
    def _check_sizes(self) -> PouredPacking:
        if self.fractions is not None and len(self.fractions) != len(self.sizes):
            rule = f"must have as many numbers as sizes, has {len(self.fractions)}, not {len(self.sizes)}"
            raise NotAllowed(rule, key=("fractions",), value=list(self.fractions))
        largest = float(self._radius().max())
        least = 6.0 * largest if self.periodic else 2.0 * largest
        size = "three diameters" if self.periodic else "the diameter"
        rule = f"must be from {least:.4g}, {size} of the largest disk, to 1e6"
        must(least <= self.width <= 1e6, rule, key=("width",), value=self.width)
        return self

    @property
    def disk_count(self) -> int:
        return self.disks

    def build(self) -> Packing:
        """Pour the disks: the same ones, in the same places, each time."""
        return _poured(self)

    def _radius(self) -> FloatArray:
        """(n,) radii with mean 1, in the order in which the disks fall."""
        numbers = generator(self.seed, self.realization)
        share = np.cumsum(self.fractions or [1.0] * len(self.sizes))
        which = np.searchsorted(share / share[-1], numbers.random(self.disks), side="right")
        radius = np.array(self.sizes)[which] * (1.0 - self.polydispersity * numbers.random(self.disks))
        return radius / exact_mean(radius)


@lru_cache(maxsize=4)
def _poured(packing: PouredPacking) -> Packing:
    radius = packing._radius()
    fall = generator(packing.seed, packing.realization).spawn(1)[0].random(packing.disks)
    heap = _Heap(radius, packing.width, packing.periodic)
    for part in fall:
        heap.drop(part)
    return Packing(
        position=heap.position,
        radius=radius,
        row=np.full(packing.disks, -1, dtype=np.int32),
        width=float(packing.width),
        periodic=packing.periodic,
    )


class _Heap:
    """The disks that lie, and the fall of the next one."""

    def __init__(self, radius: FloatArray, width: float, periodic: bool) -> None:
        self.radius, self.width, self.periodic = radius, width, periodic
        self.position = np.zeros((len(radius), 2))
        self.count = 0

    def drop(self, part: float) -> None:
        """Let the next disk fall, at this part of the way between the sides."""
        own = float(self.radius[self.count])
        left, right = (-math.inf, math.inf) if self.periodic else (own, self.width - own)
        x = part * self.width if self.periodic else left + part * (right - left)
        reach = self.radius[: self.count] + own
        height = self.position[: self.count, 1]

        under, z = self._support(x, own, reach, math.inf)
        side = math.copysign(1.0, self._away(x)[under]) if under >= 0 else 0.0
        while under >= 0:
            # along the circle of the disk under it, to the end of the circle, another circle or a wall
            offset = float(self._away(x)[under])
            along, other = self._next_circle(x, under, side, reach)
            lowest = max(own, float(height[under]))  # the floor, or the height at which it loses the disk under it
            end = math.sqrt(max(reach[under] ** 2 - (lowest - float(height[under])) ** 2, 0.0)) - side * offset
            wall = (right - x) if side > 0 else (x - left)
            step = min(along, end, wall)
            x += side * step
            if step == end and along > end + _SAME_PLACE:  # past its side, so down onto what is below it
                under, z = self._support(x, own, reach, lowest, under)
                if under < 0 or side * float(self._away(x)[under]) <= 0.0:
                    break
                continue
            z = float(height[under]) + math.sqrt(max(reach[under] ** 2 - (offset + side * step) ** 2, 0.0))
            if step == wall or side * float(self._away(x)[other]) <= 0.0:  # a hollow
                break
            under = other
        self.position[self.count] = x % self.width if self.periodic else min(max(x, left), right), z
        self.count += 1

    def _away(self, x: float) -> FloatArray:
        """How far ``x`` is to the right of each disk, the shorter way."""
        away = x - self.position[: self.count, 0]
        return away - self.width * np.round(away / self.width) if self.periodic else away

    def _support(self, x: float, own: float, reach: FloatArray, z: float, left: int = -1) -> tuple[int, float]:
        """The disk onto which one with radius ``own`` falls from ``z`` at ``x``, and its height; -1 for the floor.

        ``left`` is the disk that it has left.
        """
        below = reach**2 - self._away(x) ** 2
        top = np.where(below > 0.0, self.position[: self.count, 1] + np.sqrt(np.maximum(below, 0.0)), own)
        top[top > z + _SAME_PLACE] = own
        if left >= 0:
            top[left] = own
        under = int(top.argmax()) if self.count else -1
        return (under, float(top[under])) if under >= 0 and top[under] > own else (-1, own)

    def _next_circle(self, x: float, under: int, side: float, reach: FloatArray) -> tuple[float, int]:
        """How far along x the circle around the disk ``under`` meets another, and of which disk."""
        away = self._away(x)
        across = away[under] - away  # of the other centres, from that of ``under``
        up = self.position[: self.count, 1] - self.position[under, 1]
        squared = across**2 + up**2
        squared[under] = 1.0
        part = 0.5 * (1.0 + (reach[under] ** 2 - reach**2) / squared)
        part[under] = math.inf
        beside = reach[under] ** 2 / squared - part**2
        meets = np.flatnonzero(beside >= 0.0)
        root = np.sqrt(beside[meets])
        best, other = math.inf, -1
        for sign in (-1.0, 1.0):
            px = part[meets] * across[meets] - sign * root * up[meets]
            pz = part[meets] * up[meets] + sign * root * across[meets]
            step = side * (px - away[under])
            into = side * (pz * across[meets] - px * up[meets])  # not out of it, which is where the disk came from
            good = (step > -_SAME_PLACE) & (pz >= 0.0) & (into > _SAME_PLACE)
            if good.any():
                nearest = int(np.where(good, step, math.inf).argmin())
                if step[nearest] < best:
                    best, other = max(float(step[nearest]), 0.0), int(meets[nearest])
        return best, other
