"""Disks of the user's own as a packing: what is allowed of their numbers, rescaling, and those that a scene holds."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from ..state import FloatArray
from ..state.box import FARTHEST
from .base import Overlaps, PackingDescription, Positive, Sides, Vector
from .errors import NotAllowed, must
from .formats import Table
from .given import plain
from .packing import Packing, exact_mean

#: By which lengths of a file may be off, relatively: some formats have single precision.
ROUNDING = 1e-6
#: Least mass and radius of a disk as parts of the largest, for disks of one material the same: the rounding of others
#: hides what a lighter one does. A frictionless stack with a disk of 1e-8 counts as unstable, one of 1e-7 does not.
LEAST_MASS, LEAST_RADIUS = 1e-6, 1e-3


def packed(table: Table, left: float, floor: float, width: float, periodic: bool) -> Packing:
    """The disks above ``floor`` and right of ``left``, in a box of this ``width``, in mean radii and mean masses.

    Raises NotAllowed with the key ``(column, disk)`` for a value that is not allowed, ``(disk,)`` for a disk in the
    place of another, ``("width",)`` for a box that is too wide.
    """
    radius, places = table.radius, table.places
    x, z = table.x - left, table.z - floor
    for name, values in (("x", x), ("z", z), ("radius", radius)):
        _check(name, values, np.isfinite(values), "must be a finite number")
    _check("radius", radius, radius > 0.0, "must be greater than 0")
    mass = (radius / radius.max()) ** 2 if table.mass is None else table.mass
    _check("mass", mass, np.isfinite(mass), "must be a finite number")
    mean = exact_mean(radius)
    far = FARTHEST * mean
    must(width <= far, f"must be at most {far:g}, 1e9 mean radii", key=("width",), value=width)
    if periodic:
        x = np.mod(x, width)
    half = 0.5 * width
    wide = half * (1.0 + ROUNDING)
    large, heavy = LEAST_RADIUS * radius.max(), LEAST_MASS * mass.max()
    reach = f"from {float((table.x - radius).min()):.6g} to {float((table.x + radius).max()):.6g}"
    between = (
        f"must be between the side walls {left:g} and {left + width:g}; the disks reach {reach}, packing.origin says "
        "where left wall and floor are"
    )
    for name, values, good, rule in (
        ("x", table.x, periodic | ((x > 0.0) & (x < width)), between),
        ("radius", radius, radius <= wide, f"must be at most {half:g}, half the width of the box"),
        ("radius", radius, radius >= large, f"must be at least {large:g}, a thousandth of the largest"),
        ("z", table.z, z > 0.0, f"must be above the floor {floor:g}, which packing.origin says"),
        ("z", table.z, z <= far, f"must be at most {floor + far:g}, 1e9 mean radii"),
        ("mass", mass, mass > 0.0, "must be greater than 0"),
        ("mass", mass, mass >= heavy, f"must be at least {heavy:g}, a millionth of the largest"),
    ):
        _check(name, values, good, rule)
    order = np.lexsort((z, x))
    same = np.flatnonzero((np.diff(x[order]) == 0.0) & (np.diff(z[order]) == 0.0))
    if len(same):
        one, two = sorted(map(int, order[same[0] : same[0] + 2]))
        raise NotAllowed(f"disk is in the same place as that of {places[one]}", key=(two,))
    position = np.ascontiguousarray(np.stack([x, z], axis=1) / mean)
    return Packing(
        position=position,
        given=position,
        radius=radius / mean,
        row=np.full(len(radius), -1, dtype=np.int32),
        width=float(width / mean),
        periodic=periodic,
        given_mass=None if table.mass is None else mass / exact_mean(mass),
        columns=table.columns,
        frame=table.frame,
    )


def _check(name: str, values: FloatArray, good: NDArray[np.bool_], rule: str) -> None:
    """NotAllowed for the first of the ``values`` that is not ``good``."""
    if not np.all(good):
        bad = int(np.argmin(good))
        raise NotAllowed(rule, key=(name, bad), value=float(values[bad]))


def _check_numbers(value: Any) -> Any:
    rule = "must be a list of finite numbers, one for each disk"
    must(isinstance(value, (list, tuple)) and value and not any(type(one) not in (int, float) for one in value), rule)
    return value


Column = Annotated[tuple[float, ...], BeforeValidator(_check_numbers)]


class ArrayPacking(PackingDescription):
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
            if column is not None:
                rule = f"must have as many numbers as x, has {len(column)}, not {len(self.x)}"
                must(len(column) == len(self.x), rule, key=(name,), value=list(column))
        rule = "must be given with periodic sides"
        must(not self.periodic or self.width is not None, rule, key=("width",), value=None)
        try:
            self.build()
        except NotAllowed as problem:
            if isinstance(problem.key[0], str):
                raise
            raise NotAllowed(problem.allowed, key=("x", *problem.key), value=self.x[problem.key[0]]) from None
        return self

    @property
    def disk_count(self) -> int:
        return len(self.x)

    def build(self) -> Packing:
        """Rescale the disks."""
        x, z, radius = (np.array(values) for values in (self.x, self.z, self.radius))
        mass = None if self.mass is None else np.array(self.mass)
        left, floor = self.origin
        width = float((x + radius).max()) - left if self.width is None else self.width
        table = Table(x, z, radius, [f"disk {k}" for k in range(len(x))], mass)
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
