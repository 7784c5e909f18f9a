"""LAMMPS dump files of text: the last frame, with columns x y z (also unwrapped or scaled) and radius or diameter.

Disks are in the order of their ids, if there is a column id. Sizes and masses may be columns of the atoms or what a
compute, a fix or a variable calls by their name: ``mass``, ``c_mass``, ``v_mass[1]``.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...state import FloatArray
from .table import (
    NO_MASSES,
    FileBox,
    FormatError,
    Table,
    bounds,
    by_id,
    lines_of,
    number,
    numbers,
    shown,
    upright,
    upward,
)

_AXES = "xyz"


def read(path: Path) -> Table:
    """The disks of the last frame."""
    lines, whole = lines_of(path)
    starts = [k for k, line in enumerate(lines) if line.startswith("ITEM: TIMESTEP")]
    if not starts:
        raise FormatError("is not a LAMMPS dump file of text, must have ITEM: TIMESTEP")
    headings = [k for k in range(starts[-1], len(lines)) if lines[k].startswith("ITEM: ")]
    parts = ("NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS")
    items = {name: k for k in headings for name in parts if lines[k].startswith(f"ITEM: {name}")}
    try:
        count = int(lines[items["NUMBER OF ATOMS"] + 1])
        box, atoms = items["BOX BOUNDS"], items["ATOMS"]
        rows = [line.split() for line in lines[atoms + 1 : atoms + 1 + count]]
    except (KeyError, IndexError, ValueError):
        raise FormatError("is not a whole LAMMPS dump file: the last frame lacks its number, box or atoms") from None
    if len(rows) != count or not count:
        raise FormatError(f"holds {len(rows)} of {count} atoms in its last frame")
    if not whole:
        raise FormatError("is cut: its last line has no end")
    flags, sides = _box(lines, box)
    names = lines[atoms].split()[2:]
    places = [f"line {atoms + 2 + k}" for k in range(count)]
    for cells, place in zip(rows, places, strict=True):
        if len(cells) != len(names):
            raise FormatError(f"has {len(cells)} values, must have {len(names)} as ITEM: ATOMS", place)
    if "id" in names:
        order = by_id([cells[names.index("id")] for cells in rows], places)
        rows, places = [rows[k] for k in order], [places[k] for k in order]
    heading = f"line {atoms + 1}"

    def column(at: int) -> FloatArray:
        return np.array([number(cells[at], names[at], place) for cells, place in zip(rows, places, strict=True)])

    def coordinate(axis: int) -> FloatArray:
        low, size = sides[axis]
        for ending, scaled in (("", False), ("u", False), ("s", True), ("su", True)):
            if (name := _AXES[axis] + ending) in names:
                values = column(names.index(name))
                return low + size * values if scaled else values
        raise FormatError(f"column {_AXES[axis]} is missing", heading)

    def quantity(*words: str) -> FloatArray | None:
        found = [k for k, name in enumerate(names) if _plain(name) in words]
        if len(found) > 1:
            several = ", ".join(shown(names[k]) for k in found)
            raise FormatError(f"columns {several}: must have one of them", heading)
        return column(found[0]) if found else None

    radius, diameter = quantity("radius"), quantity("diameter")
    if radius is None and diameter is not None:
        radius = 0.5 * diameter
    if radius is None:
        raise FormatError("column radius or diameter is missing", heading)
    mass, density = quantity("mass", "rmass"), quantity("density")
    if mass is None and density is not None:
        mass = density * (2.0 * radius) ** 3  # of a sphere, as LAMMPS has it
    x, y, z = (coordinate(axis) for axis in range(3))
    up = upward(y, z if np.ptp(z) else 0.0 * z)  # where all z are the same, that is anywhere in the box
    bounded = _file_box(flags, sides, _AXES.index(up))
    return Table(x, y if up == "y" else z, radius, places, mass, bounded, NO_MASSES if mass is None else "")


def _plain(name: str) -> str:
    """The name of a column without what says where it comes from."""
    return re.sub(r"^(?:c|f|v|i|d)2?_|(?:\[\d+\])+$", "", name).casefold()


def _box(lines: list[str], at: int) -> tuple[list[str], list[tuple[float, float]]]:
    """Flags of the three axes, if there are any, and along each where the box begins and how far it reaches.

    Tilted boxes have three numbers a line, those of newer versions an edge and a component of the origin.
    """
    words, heading = lines[at].split()[3:], f"line {at + 1}"
    flags = [word for word in words if re.fullmatch("[pfsm]{2}", word)]
    edges = words[:2] == ["abc", "origin"]
    if len(flags) not in (0, 3) or len(lines) < at + 4:
        raise FormatError("must be followed by three lines of bounds, and have flags of three axes or none", heading)
    names = [*_AXES, "origin"] if edges else ["lo", "hi", "tilt"] if "xy" in words else ["lo", "hi"]
    sides = []
    for axis in range(3):
        place = f"line {at + 2 + axis}"
        values = numbers(lines[at + 1 + axis].split(), names, place)
        if edges:
            upright(values[:axis] + values[axis + 1 : 3], place)
            values = [values[3], values[3] + values[axis]]
        upright(values[2:], place)
        sides.append(bounds(values[0], values[1], _AXES[axis], place))
    return flags, sides


def _file_box(flags: list[str], sides: list[tuple[float, float]], up: int) -> FileBox:
    """What bounds the disks: p is periodic, f a side that stays; s and m follow the disks, and p has no floor."""
    (left, width), (floor, _) = sides[0], sides[up]
    if not flags:
        return FileBox(left, width, reason="a dump without flags does not say what bounds its disks")
    reason = f"the bounds are {flags[0]} in x and {flags[up]} in {_AXES[up]}, those of walls and a floor ff (pp) and f"
    known = flags[0] in ("pp", "ff")
    return FileBox(
        left if known else None, width if known else None, floor if flags[up][0] == "f" else None, flags[0] == "pp",
        reason,
    )  # fmt: skip
