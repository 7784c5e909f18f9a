"""A packing of the user's own, read from a table of disks."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, PrivateAttr, ValidationInfo, model_validator

from .base import Description, Positive, Sides, allowed
from .errors import Problem, SceneError, describe, show
from .packing import Packing, exact_mean

COLUMNS = ("x", "z", "radius")


def _printable(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise Problem("")
    return text


FileName = Annotated[str, Field(strict=True), AfterValidator(_printable), allowed("must be the path of a CSV file")]


class FilePacking(Description):
    """Disks from a CSV file with the columns x, z and radius, in any one unit of length.

    Further columns are ignored, and so are empty lines and lines that begin with ``#``. Every centre lies
    above the floor ``z = 0`` and between the side walls ``x = 0`` and ``x = width``. Lengths, the width too,
    are rescaled to a mean radius of 1.
    """

    kind: Literal["file"] = Field(default="file", description="Disks from a CSV file.")
    path: FileName = Field(
        description="CSV file with the columns x, z, radius. A relative path starts at the folder of the scene file."
    )
    width: Positive = Field(
        description="Distance of the side walls, or the period with periodic sides, in the unit of length of the file."
    )
    sides: Sides = "walls"

    # Not part of the description: where it was read, so that a worker process finds the table too.
    _folder: str | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _remember_folder(self, info: ValidationInfo) -> FilePacking:
        if info.context and info.context.get("folder") is not None:
            self._folder = str(info.context["folder"])
        return self

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
            For a file that is missing or cannot be read, a missing column, and, with the number of its line,
            for a row that is truncated, a value that is no finite number, a radius that is not positive, a
            centre outside the box, or two disks in one place.
        """
        table, lines = self._read()
        x, z, radius = table
        for name, values, good, rule in (
            ("radius", radius, radius > 0.0, "must be greater than 0"),
            ("x", x, (x > 0.0) & (x < self.width), f"must be between the side walls 0 and {self.width:g}"),
            ("z", z, z > 0.0, "must be above the floor 0"),
        ):
            if not good.all():
                bad = int(np.argmin(good))
                raise self._error(lines[bad], f"{name} = {float(values[bad])!r}: {rule}")
        order = np.lexsort((z, x))
        same = np.flatnonzero((np.diff(x[order]) == 0.0) & (np.diff(z[order]) == 0.0))
        if len(same):
            one, two = sorted(lines[i] for i in order[same[0] : same[0] + 2])
            raise self._error(two, f"disk is in the same place as that of line {one}")

        mean = exact_mean(radius)
        return Packing(
            position=np.ascontiguousarray(np.stack([x, z], axis=1) / mean),
            radius=radius / mean,
            row=np.full(len(radius), -1, dtype=np.int32),
            width=float(self.width / mean),
            periodic=self.periodic,
        )

    def _read(self) -> tuple[np.ndarray, list[int]]:
        """(3, n) values of the columns, and the line of each disk in the file."""
        rows: list[list[float]] = []
        lines: list[int] = []
        header: list[str] | None = None
        try:
            with self.file.open(encoding="utf-8-sig", newline="") as stream:
                reader = csv.reader(stream, skipinitialspace=True)
                for cells in reader:
                    if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                        continue
                    if header is None:
                        header = [cell.strip() for cell in cells]
                        place = self._places(header)
                        continue
                    if len(cells) != len(header):
                        rule = f"has {len(cells)} values, must have {len(header)} as the header"
                        raise self._error(reader.line_num, rule)
                    rows.append([self._number(reader.line_num, c, cells[place[c]]) for c in COLUMNS])
                    lines.append(reader.line_num)
        except FileNotFoundError:
            raise self._error(None, "no such file") from None
        except UnicodeEncodeError:
            raise self._error(None, "has a name that this locale cannot spell") from None
        except UnicodeDecodeError:
            raise self._error(None, "is not a text file in UTF-8") from None
        except csv.Error as error:
            raise self._error(None, f"is not a CSV file: {error}") from None
        except OSError as error:
            raise self._error(None, f"cannot be read: {error.strerror}") from None
        if not rows:
            raise self._error(None, "has no disks, must have a header x,z,radius and a line for each disk")
        return np.array(rows).T, lines

    def _places(self, header: list[str]) -> dict[str, int]:
        for column in COLUMNS:
            if (times := header.count(column)) != 1:
                problem = "is missing" if times == 0 else f"is given {times} times"
                # what stands there is not quoted: the file may be another one, and not meant for the eye
                raise self._error(None, f"column {column} {problem}, header must name x, z and radius")
        return {column: header.index(column) for column in COLUMNS}

    def _number(self, line: int, column: str, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self._error(line, f"{column} = {show(text.strip())}: must be a finite number")
        return value

    def _error(self, line: int | None, rule: Any) -> SceneError:
        where = f"line {line}: " if line is not None else ""
        return SceneError(describe(("packing", "path"), self.path, f"{where}{rule}"))
