"""A packing of the user's own, read from a table of disks."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, ValidationInfo, model_validator

from ..inputs import unreadable
from . import formats
from .arrays import ROUNDING, packed
from .base import Overlaps, PackingDescription, Positive, Sides, Vector, allowed
from .errors import NotAllowed, SceneError, describe, must, show
from .formats import csv_table
from .packing import Packing, exact_mean

T = TypeVar("T")


def _printable(text: str) -> str:
    must(text.strip() and text.isprintable(), "")
    return text


FileName = Annotated[str, Field(strict=True), AfterValidator(_printable), allowed("must be the path of a file")]
Format = Annotated[
    Literal["csv", "lammps-data", "lammps-dump", "gsd"], allowed(f"must be {' or '.join(formats.SUFFIXES)}")
]


def _check_columns(value: Any) -> Any:
    text = isinstance(value, Mapping) and all(isinstance(one, str) and one.strip() for one in value.values())
    rule = f"must be columns of a CSV table, as {{z: Y, radius: R}}, for {', '.join(csv_table.NAMED)}"
    must(text and value and set(value) <= set(csv_table.NAMED), rule)
    must(len({one.strip().removeprefix("-") for one in value.values()}) >= len(value), "must name a column once")
    return dict(value)


class FilePacking(PackingDescription):
    """Disks from a file: CSV with the columns x, z and radius, or what another program wrote (``scene.formats``).

    Lengths are in any one unit. Every centre lies above the floor and between the side walls; periodic sides take any
    x. Floor and walls are those of the box in the file; a table without a box has the floor ``z = 0`` and the left wall
    ``x = 0``. Where the box shrinks to the disks, or is of an unknown kind, ``width`` and ``origin`` must be given.
    Lengths, the width too, are rescaled to a mean radius of 1, masses to a mean of 1.

    Examples
    --------
    >>> packing = gr.File(path="disks.csv", width=10.0)
    >>> gr.Scene(packing=packing).packing.sides
    'walls'
    """

    kind: Literal["file"] = Field(default="file", description="Disks from a file.")
    path: FileName = Field(description="File with x, z and radius of each disk, from the folder of the scene file.")
    format: Format | None = Field(
        default=None, description="Format of the file; null: by its extension, csv for an unknown one."
    )
    width: Positive | None = Field(
        default=None,
        description="Distance of the side walls, or the period, in the file's unit; null is the width of its box.",
    )
    origin: Vector | None = Field(
        default=None,
        description="[x, z] of left wall and floor in coordinates of the file; null is the lower left corner of its "
        "box.",
    )
    sides: Sides = "walls"
    columns: Annotated[dict[str, str], BeforeValidator(_check_columns)] | None = Field(
        default=None,
        description="Columns of a CSV table, such as {z: Y, radius: R}, and {z: -Y} where Y points down; null: those "
        "named x, z (or y), radius (or r, diameter, d), mass and density.",
    )
    overlaps: Overlaps = "kept"
    springs: FileName | None = Field(
        default=None,
        description="File with the forces of all contacts, for a packing at rest that goes on with its tangential "
        "springs: a .contacts.csv of this package, or a LAMMPS dump of patom1 patom2 and pair/local force p1 p2 p3.",
    )
    sparse: ClassVar[tuple[str, ...]] = ("columns", "overlaps", "springs")

    # Not part of the description: where it was read, so that a worker process finds the table too.
    _folder: str | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _remember_folder(self, info: ValidationInfo) -> FilePacking:
        folder = info.context.get("folder") if info.context else None
        if folder is None or str(folder) == self._folder:
            return self
        own = self.model_copy()  # another scene may have the same packing
        own._folder = str(folder)
        return own

    @model_validator(mode="after")
    def _check_format(self) -> FilePacking:
        if self.columns is not None and (known := self.format or formats.by_suffix(self.path)) != "csv":
            rule = f"must be left out, format {known} says what its columns are"
            raise NotAllowed(rule, key=("columns",), value=self.columns)
        rule = "must be kept with springs"
        must(self.springs is None or self.overlaps != "removed", rule, key=("overlaps",), value=self.overlaps)
        return self

    @property
    def folder(self) -> str | None:
        """Folder at which a relative path starts; None for the current one."""
        return self._folder

    @property
    def files(self) -> list[Path]:
        return [Path(self._folder or ".", one) for one in (self.path, self.springs) if one]

    def _table(self) -> formats.Table:
        return self._read(
            lambda: formats.read(self.files[0], self.format or formats.by_suffix(self.path), self.columns)
        )

    def mean_radius(self) -> float | None:
        """Mean radius in m; None where the table names no unit of length. Raises SceneError if it cannot be read."""
        table = self._table()
        metres = csv_table.METRES.get(table.unit)
        return None if metres is None else exact_mean(table.radius) * metres

    def build(self) -> Packing:
        """Read the table and rescale it.

        Raises SceneError for a file that is missing, cannot be read or is not of its format, and, with its place in the
        file, for a value that is no finite number, a radius or mass that is not positive, or so small that it is lost
        beside the largest, a centre outside the box or too far away, or two disks in one place; for a width or an
        origin that neither the scene nor the file gives, a disk wider than that, and sides or a period other than those
        that the file says.

        Warns (UserWarning) where a file of another program has disks of several sizes and no masses, where a table has
        several frames, of which the last is taken, and where ``y`` of a picture is taken as the height.
        """
        table = self._table()
        try:
            packing = packed(table, *self._sides(table.box), self.periodic)
        except NotAllowed as problem:
            *name, place = problem.key
            if isinstance(place, str):
                raise SceneError(describe(("packing", place), problem.value, problem.allowed)) from None
            value = f"{name[0]} = {problem.value!r}: " if name else ""
            raise self._error(value + problem.allowed, table.places[place]) from None
        if table.remark and np.ptp(table.radius) > ROUNDING * exact_mean(table.radius):
            warnings.warn(f"{self.path}: {table.remark}", stacklevel=2)
        for note in table.notes:
            warnings.warn(f"{self.path}: {note}", stacklevel=2)
        if self.springs is None:
            return packing
        from .contacts import read as read_contacts  # few packings have such a file

        read = partial(read_contacts, self.files[1], packing.position, packing.box, table)
        return replace(packing, contacts=self._read(read, "springs"))

    def _sides(self, box: formats.FileBox) -> tuple[float, float, float]:
        """Left wall, floor and width in coordinates of the file; NotAllowed where they are not known or disagree."""
        there, said = ("periodic", "is periodic") if box.periodic else ("walls", "is not periodic")
        rule = f"must be {there}, the box of {show(self.path)} {said} in x"
        must(box.periodic in (None, self.periodic), rule, key=("sides",), value=self.sides)
        known = box.periodic is not None or self.periodic or box is formats.NO_BOX
        width = self.width if self.width is not None else box.width if known else None
        left, floor = self.origin or (box.left if known else None, box.floor)
        if width is None or left is None or floor is None:
            key = "width" if width is None else "origin"
            both = ", and origin as [left wall, floor]" if left is None or floor is None else ""
            given = f"must be given{both}" if key == "width" else "must be given as [left wall, floor]"
            where = " in coordinates of the file" if both else ""
            raise NotAllowed(f"{given}{where}, {box.reason}", key=(key,), value=None)
        if box.periodic and box.width is not None:
            rule = f"must be {box.width!r} or left out, the period of the box of {show(self.path)}"
            must(math.isclose(width, box.width, rel_tol=ROUNDING), rule, key=("width",), value=width)
        return left, floor, width

    def _read(self, read: Callable[[], T], key: str = "path") -> T:
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # what overflows is refused where it stands
                return read()
        except formats.FormatError as error:
            raise self._error(str(error), error.place, key) from None
        except (OSError, UnicodeError) as error:
            raise self._error(unreadable(error), key=key) from None

    def _error(self, rule: str, place: str = "", key: str = "path") -> SceneError:
        return SceneError(describe(("packing", key), getattr(self, key), f"{place}: {rule}" if place else rule))
