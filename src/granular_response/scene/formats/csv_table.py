"""CSV with a header that names x, z and radius, and mass or density if disks differ in material.

Further columns are ignored, and so are empty lines and lines that begin with ``#``.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from .table import FormatError, Table, numbers

COLUMNS = ("x", "z", "radius")
MATERIAL = ("mass", "density")
#: Columns that look as if they were heeded, and cannot be: contacts have one law.
REFUSED = {"stiffness": "contact.normal_stiffness", "friction": "contact.friction"}


def read(path: Path) -> Table:
    """The disks of a table; errors name the line."""
    rows: list[list[float]] = []
    places: list[str] = []
    header: list[str] | None = None
    names: tuple[str, ...] = COLUMNS
    with path.open(encoding="utf-8-sig", newline="") as stream:
        reader = csv.reader(stream, skipinitialspace=True)
        try:
            for cells in reader:
                if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                    continue
                if header is None:
                    header = [cell.strip() for cell in cells]
                    names = _names(header)
                    columns = [header.index(name) for name in names]
                    continue
                place = f"line {reader.line_num}"
                if len(cells) != len(header):
                    raise FormatError(f"has {len(cells)} values, must have {len(header)} as the header", place)
                rows.append(numbers([cells[column] for column in columns], names, place))
                places.append(place)
        except csv.Error as error:
            raise FormatError(f"is not a CSV file: {error}") from None
    if not rows:
        raise FormatError("has no disks, must have a header x,z,radius and a line for each disk")
    x, z, radius, *material = np.array(rows).T
    for values, name in zip(material, names[3:], strict=True):
        if not (values > 0.0).all():
            bad = int(np.argmin(values > 0.0))
            raise FormatError(f"{name} = {float(values[bad])!r}: must be greater than 0", places[bad])
    mass = None
    if material:
        mass = material[0] if names[3] == "mass" else material[0] * radius**2
    return Table(x, z, radius, places, mass)


def _names(header: list[str]) -> tuple[str, ...]:
    """The columns that are read. What stands in the header is not quoted: the file may be another one."""
    for column in COLUMNS:
        if (times := header.count(column)) != 1:
            problem = "is missing" if times == 0 else f"is given {times} times"
            raise FormatError(f"column {column} {problem}, header must name x, z and radius")
    for column, key in REFUSED.items():
        if column in header:
            raise FormatError(f"column {column}: must be left out, {key} is that of all disks")
    material = tuple(name for name in MATERIAL if name in header)
    if len(material) > 1 or any(header.count(name) > 1 for name in material):
        raise FormatError("columns mass and density: must have one of them, once")
    return COLUMNS + material
