"""CSV with a header that names x, z and radius, and mass or density if disks differ in material.

Names may be written in any case, with a unit in brackets. Further columns are ignored, and so are empty lines and lines
that begin with ``#``, but for the mark of our own tables.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from ..errors import suggestion
from .table import NO_BOX, FormatError, Mark, Table, lines_of, number, numbers

COLUMNS = ("x", "z", "radius")
MATERIAL = ("mass", "density")
#: Columns that are read where they are, and taken where ``motion`` asks for them.
MOTION = ("vx", "vz", "spin")
#: Columns that look as if they were heeded, and cannot be: contacts have one law.
REFUSED = {
    **dict.fromkeys(("friction", "mu", "µ", "μ", "friction_coefficient"), "contact.friction"),
    **dict.fromkeys(("stiffness", "kn", "k_n", "young", "youngs_modulus", "young_modulus"), "contact.normal_stiffness"),
    "cohesion": "contact.law",
}
#: Other words for mass and density.
_OTHER_WORDS = {"m": "mass", "rmass": "mass", "weight": "mass", "rho": "density", "ρ": "density"}


def read(path: Path) -> Table:
    """The disks of a table; errors name the line."""
    rows: list[list[float]] = []
    moved: list[list[float]] = []
    places: list[str] = []
    header: tuple[str, ...] = ()
    names: tuple[str, ...] = COLUMNS
    mark: Mark | None = None
    lines, whole = lines_of(path)
    reader = csv.reader((f"{line}\n" for line in lines), skipinitialspace=True)
    try:
        for cells in reader:
            place = f"line {reader.line_num}"
            if not any(cell.strip() for cell in cells):
                continue
            if cells[0].lstrip().startswith("#"):
                mark = mark or Mark.found(lines[reader.line_num - 1], place)
                continue
            if not header:
                header, units = zip(*map(_name_and_unit, cells), strict=True)
                names = _names(header, units)
                columns = [header.index(name) for name in names]
                motion = [name for name in MOTION if header.count(name) == 1]
                continue
            if len(cells) != len(header):
                raise FormatError(f"has {len(cells)} values, must have {len(header)} as the header", place)
            rows.append(numbers([cells[column] for column in columns], names, place))
            moved.append([_or_nan(cells[header.index(name)]) for name in motion])
            places.append(place)
    except csv.Error as error:
        raise FormatError(f"is not a CSV file: {error}") from None
    if not rows:
        raise FormatError("has no disks, must have a header x,z,radius and a line for each disk")
    if mark is not None:
        mark.check(len(rows), whole)
    x, z, radius, *material = np.array(rows).T
    for values, name in zip(material, names[3:], strict=True):
        if not (values > 0.0).all():
            bad = int(np.argmin(values > 0.0))
            raise FormatError(f"{name} = {float(values[bad])!r}: must be greater than 0", places[bad])
    mass = None
    if material:
        mass = material[0] if names[3] == "mass" else material[0] * radius**2
    velocities = dict(zip(motion, np.array(moved).T, strict=True))
    return Table(x, z, radius, places, mass, NO_BOX if mark is None else mark.box, columns=velocities or None)


def _or_nan(cell: str) -> float:
    try:
        return number(cell, "", "")
    except FormatError:
        return float("nan")


def _name_and_unit(cell: str) -> tuple[str, str]:
    """The name of a column, in small letters, and its unit: ``Radius [mm]`` is radius and mm."""
    match = re.fullmatch(r"\s*([^(\[]*?)\s*(?:[(\[]([^)\]]*)[)\]])?\s*", cell)
    return (match[1].casefold(), (match[2] or "").strip()) if match else (cell.strip(), "")


def _names(header: tuple[str, ...], units: tuple[str, ...]) -> tuple[str, ...]:
    """The columns that are read. What stands in the header is not quoted: the file may be another one."""
    for column in COLUMNS:
        if (times := header.count(column)) != 1:
            problem = "is missing" if times == 0 else f"is given {times} times"
            raise FormatError(f"column {column} {problem}, header must name x, z and radius")
    if len({units[header.index(column)] for column in COLUMNS}) > 1:
        raise FormatError("columns x, z and radius: must have the same unit of length")
    for column, key in REFUSED.items():
        if column in header:
            raise FormatError(f"column {column}: must be left out, {key} is that of all disks")
    material = tuple(name for name in MATERIAL if name in header)
    if len(material) > 1 or any(header.count(name) > 1 for name in material):
        raise FormatError("columns mass and density: must have one of them, once")
    if not material:
        for column in header:
            if (meant := _OTHER_WORDS.get(column)) or (meant := suggestion(column, MATERIAL)):
                rule = meant if meant.startswith(",") else f", did you mean {meant}?"
                raise FormatError(f"column {column}: unknown{rule} (mass or density, or neither)")
    return COLUMNS + material
