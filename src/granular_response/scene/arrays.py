"""A packing of the user's own, given as numbers in the scene itself."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from . import formats
from .base import Overlaps, PackingDescription, Positive, Sides, Sparse, Vector
from .disks import packed
from .errors import Problem
from .given import plain
from .packing import Packing


def _check_numbers(value: Any) -> Any:
    if not isinstance(value, (list, tuple)) or not value or any(type(one) not in (int, float) for one in value):
        raise Problem("must be a list of finite numbers, one for each disk")
    return value


Column = Annotated[tuple[float, ...], BeforeValidator(_check_numbers)]


class ArrayPacking(Sparse, PackingDescription):
    """Disks given by their numbers; ``Scene.from_arrays`` makes one of arrays.

    Lengths are in any one unit, masses too. Every centre lies above the floor and between the side walls; periodic
    sides take any x. Lengths, the width too, are rescaled to a mean radius of 1, masses to a mean of 1.

    Examples
    --------
    >>> gr.Arrays(x=[1.0, 3.0], z=[1.0, 1.0], radius=[1.0, 1.0], width=8.0).build()
    Packing(2 disks, radii from 1 to 1, box 8 wide)
    """

    kind: Literal["arrays"] = Field(default="arrays", description="Disks given as numbers.")
    x: Column = Field(repr=False, description="Horizontal position of each centre, in any unit of length.")
    z: Column = Field(repr=False, description="Height of each centre.")
    radius: Column = Field(repr=False, description="Radius of each disk.")
    mass: Column | None = Field(
        default=None, repr=False, description="Mass of each disk; null: proportional to the square of the radius."
    )
    width: Positive | None = Field(
        default=None,
        description="Distance of the side walls, or the period; null: the right wall touches the disk that "
        "reaches farthest.",
    )
    origin: Vector = Field(default=(0.0, 0.0), description="[x, z] of left wall and floor.")
    sides: Sides = "walls"
    overlaps: Overlaps = "kept"
    sparse: ClassVar[tuple[str, ...]] = ("overlaps",)

    @model_validator(mode="after")
    def _check_disks(self) -> ArrayPacking:
        for name in ("z", "radius", "mass"):
            column = getattr(self, name)
            if column is not None and len(column) != len(self.x):
                rule = f"must have as many numbers as x, has {len(column)}, not {len(self.x)}"
                raise Problem(rule, key=(name,), value=list(column))
        if self.periodic and self.width is None:
            raise Problem("must be given with periodic sides", key=("width",), value=None)
        try:
            self.build()
        except Problem as problem:
            if isinstance(problem.key[0], str):
                raise
            raise Problem(problem.allowed, key=("x", *problem.key), value=self.x[problem.key[0]]) from None
        return self

    @property
    def disk_count(self) -> int:
        """Number of disks."""
        return len(self.x)

    def build(self) -> Packing:
        """Rescale the disks."""
        x, z, radius = (np.array(values) for values in (self.x, self.z, self.radius))
        mass = None if self.mass is None else np.array(self.mass)
        left, floor = self.origin
        width = float((x + radius).max()) - left if self.width is None else self.width
        table = formats.Table(x, z, radius, [f"disk {k}" for k in range(len(x))], mass)
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is refused
            return packed(table, left, floor, width, self.periodic)


def listed(values: Any, count: int | None = None) -> Any:
    """An array, a table's column or a list as a list; a lone number ``count`` times where that is given."""
    found = plain(values)
    lone = isinstance(found, (int, float)) and not isinstance(found, bool)
    return [found] * count if lone and count is not None else found


def shortened(scene: dict[str, Any]) -> dict[str, Any]:
    """The data of a scene for people: how many numbers a packing has in place of them."""
    packing = scene.get("packing", {})
    if packing.get("kind") != "arrays":
        return scene
    counted = {
        key: f"{len(value)} numbers" for key, value in packing.items() if key in ("x", "z", "radius", "mass") and value
    }
    return {**scene, "packing": {**packing, **counted}}
