"""LAMMPS data files with atoms of style sphere: ``id type diameter density x y z``.

Disks are in the order of their ids. Masses are those that LAMMPS gives such atoms, density times the volume of the
sphere. The format says how large the box is, and not whether its sides are walls or follow the disks; the first line of
our own files does.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import FileBox, FormatError, Mark, Table, bounds, by_id, lines_of, numbers, upright, upward

_COLUMNS = ("diameter", "density", "x", "y", "z")
_REASON = "a LAMMPS data file does not say what bounds its disks"
#: Edges of a box in newer files, and which of the components must be 0.
_EDGES = ("avec", "bvec", "cvec")


def read(path: Path) -> Table:
    """The disks of section Atoms."""
    count: int | None = None
    sides: dict[str, tuple[float, float]] = {}
    corner: list[float] | None = None
    ids: list[str] = []
    rows: list[list[float]] = []
    places: list[str] = []
    inside = False
    lines, whole = lines_of(path)
    mark = Mark.found(lines[0], "line 1") if lines else None
    for line_number, line in enumerate(lines[1:], start=2):
        text, _, comment = line.partition("#")
        cells, place = text.split(), f"line {line_number}"
        if not cells:
            continue
        if cells[0][0].isalpha():
            inside = cells == ["Atoms"]
            if inside and comment.strip() != "sphere":  # other styles have as many columns
                raise FormatError("atoms must be of style sphere, and say so: Atoms # sphere", place)
        elif inside:
            if len(cells) not in (7, 10):  # three numbers of the periodic image may follow
                raise FormatError(f"has {len(cells)} values, must have id type diameter density x y z", place)
            ids.append(cells[0])
            rows.append(numbers(cells[2:7], _COLUMNS, place))
            places.append(place)
        elif cells[1:] == ["atoms"] and cells[0].isdecimal() and len(cells[0]) <= 20:
            count = int(cells[0])
        elif len(cells) == 4 and cells[2:] in (["xlo", "xhi"], ["ylo", "yhi"], ["zlo", "zhi"]):
            low, high = numbers(cells[:2], cells[2:], place)
            sides[cells[2][0]] = bounds(low, high, cells[2][0], place)
        elif cells[3:] == ["xy", "xz", "yz"]:
            upright(numbers(cells[:3], cells[3:], place), place)
        elif len(cells) == 4 and cells[3] in _EDGES:
            k = _EDGES.index(cells[3])
            edge = numbers(cells[:3], ("x", "y", "z"), place)
            upright(edge[:k] + edge[k + 1 :], place)
            sides["xyz"[k]] = bounds(0.0, edge[k], "xyz"[k], place)
        elif cells[3:] == ["abc", "origin"]:
            corner = numbers(cells[:3], ("x", "y", "z"), place)
    if corner is not None:
        sides = {axis: (low + corner["xyz".index(axis)], size) for axis, (low, size) in sides.items()}
    if count is None or "x" not in sides or len(rows) != count:
        rule = f"must have the headers atoms and xlo xhi, and as many atoms as it says (found {len(rows)})"
        raise FormatError(f"is not a whole LAMMPS data file, {rule}")
    if not rows:
        raise FormatError("has no atoms")
    if not whole:
        raise FormatError("is cut: its last line has no end")
    if mark is not None:
        mark.check(len(rows), whole)
    order = by_id(ids, places)
    diameter, density, x, y, z = np.array(rows)[order].T
    left, width = sides["x"]
    return Table(
        x, z if upward(y, z) == "z" else y, 0.5 * diameter, [places[k] for k in order], density * diameter**3,
        FileBox(left, width, reason=_REASON) if mark is None else mark.box,
    )  # fmt: skip
