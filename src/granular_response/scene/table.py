"""A packing of the user's own, read from a table of disks."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, PrivateAttr, ValidationInfo, model_validator

from . import formats
from .base import Description, Positive, Sides, allowed
from .errors import Problem, SceneError, describe, show
from .packing import Packing, exact_mean

_FORMATS = " or ".join(formats.SUFFIXES)
#: By which lengths of a file may be off, relatively: some formats have single precision.
_ROUNDING = 1e-6


def _printable(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise Problem("")
    return text


def _known(text: str) -> str:
    if text not in formats.SUFFIXES:
        raise Problem("")
    return text


FileName = Annotated[str, Field(strict=True), AfterValidator(_printable), allowed("must be the path of a file")]
Format = Annotated[str, Field(strict=True), AfterValidator(_known), allowed(f"must be {_FORMATS}")]


class FilePacking(Description):
    """Disks from a file: CSV with the columns x, z and radius, or what another program wrote (``scene.formats``).

    Lengths are in any one unit. Every centre lies above the floor ``z = 0`` and between the side walls ``x = 0`` and
    ``x = width``; periodic sides take any x. Lengths, the width too, are rescaled to a mean radius of 1, masses to a
    mean of 1.
    """

    kind: Literal["file"] = Field(default="file", description="Disks from a file.")
    path: FileName = Field(
        description="File with x, z and radius of each disk. A relative path starts at the folder of the scene file."
    )
    format: Format | None = Field(
        default=None, description="Format of the file; null goes by the ending of its name, csv for an unknown one."
    )
    width: Positive | None = Field(
        default=None,
        description="Distance of the side walls, or the period with periodic sides, in the unit of length of the file; "
        "null is the width of its box.",
    )
    sides: Sides = "walls"

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

    @property
    def disk_count(self) -> int:
        """0: only the file knows the number of disks."""
        return 0

    @property
    def folder(self) -> str | None:
        """Folder at which a relative path starts; None for the current one."""
        return self._folder

    @property
    def file(self) -> Path:
        """The table's place."""
        return Path(self._folder or ".", self.path)

    @property
    def periodic(self) -> bool:
        """Whether the sides are periodic."""
        return self.sides == "periodic"

    def half(self) -> None:
        """See ``LatticePacking.half``: a table has no smaller one."""

    def build(self) -> Packing:
        """Read the table and rescale it.

        Raises
        ------
        SceneError
            For a file that is missing, cannot be read or is not of its format, and, with its place in the file, for a
            value that is no finite number, a radius or mass that is not positive, a centre outside the box, or two
            disks in one place; for a width that neither the scene nor the file gives, a disk wider than that, and sides
            or a period other than those that the file says.
        """
        table = self._read()
        x, z, radius, places = table.x, table.z, table.radius, table.places
        width = table.width if self.width is None else self.width
        if width is None:
            raise SceneError(describe(("packing", "width"), None, "must be given, the file has no box"))
        if table.periodic not in (None, self.periodic):
            there, box = ("periodic", "is periodic") if table.periodic else ("walls", "is not periodic")
            rule = f"must be {there}, the box of {show(self.path)} {box} in x"
            raise SceneError(describe(("packing", "sides"), self.sides, rule))
        if table.periodic and table.width is not None and not math.isclose(width, table.width, rel_tol=_ROUNDING):
            rule = f"must be {table.width!r} or left out, the period of the box of {show(self.path)}"
            raise SceneError(describe(("packing", "width"), width, rule))
        if self.periodic:
            x = np.mod(x, width)
        half = 0.5 * width
        fits = radius <= half * (1.0 + _ROUNDING)
        mass = np.ones(len(x)) if table.mass is None else table.mass
        for name, values, good, rule in (
            ("radius", radius, radius > 0.0, "must be greater than 0"),
            ("radius", radius, fits, f"must be at most {half:g}, half the width of the box"),
            ("x", x, self.periodic | ((x > 0.0) & (x < width)), f"must be between the side walls 0 and {width:g}"),
            ("z", z, z > 0.0, "must be above the floor 0"),
            ("mass", mass, mass > 0.0, "must be greater than 0"),
        ):
            if not good.all():
                bad = int(np.argmin(good))
                raise self._error(f"{name} = {float(values[bad])!r}: {rule}", places[bad])
        order = np.lexsort((z, x))
        same = np.flatnonzero((np.diff(x[order]) == 0.0) & (np.diff(z[order]) == 0.0))
        if len(same):
            one, two = sorted(order[same[0] : same[0] + 2])
            raise self._error(f"disk is in the same place as that of {places[one]}", places[two])

        mean = exact_mean(radius)
        return Packing(
            position=np.ascontiguousarray(np.stack([x, z], axis=1) / mean),
            radius=radius / mean,
            row=np.full(len(radius), -1, dtype=np.int32),
            width=float(width / mean),
            periodic=self.periodic,
            given_mass=None if table.mass is None else mass / exact_mean(mass),
        )

    def _read(self) -> formats.Table:
        try:
            return formats.read(self.file, self.format or formats.by_suffix(self.path))
        except formats.FormatError as error:
            raise self._error(str(error), error.place) from None
        except FileNotFoundError:
            raise self._error("no such file") from None
        except UnicodeEncodeError:
            raise self._error("has a name that this locale cannot spell") from None
        except UnicodeDecodeError:
            raise self._error("is not a text file in UTF-8") from None
        except OSError as error:
            raise self._error(f"cannot be read: {error.strerror}") from None

    def _error(self, rule: str, place: str = "") -> SceneError:
        return SceneError(describe(("packing", "path"), self.path, f"{place}: {rule}" if place else rule))
