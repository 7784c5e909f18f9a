"""LAMMPS data files with atoms of style sphere: ``id type diameter density x y z``.

Disks are in the order of their ids. Masses are those that LAMMPS gives such atoms, density times the volume of the
sphere.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import FormatError, Table, by_id, heights, numbers

_COLUMNS = ("diameter", "density", "x", "y", "z")


def read(path: Path) -> Table:
    """The disks of section Atoms, from the lower corner of the box."""
    count, bounds, ids, rows, places = None, {}, [], [], []
    inside = False
    with path.open(encoding="utf-8") as stream:
        title = next(stream, "")  # of our own files it says whether the box is periodic
        for line_number, line in enumerate(stream, start=2):
            text, _, comment = line.partition("#")
            cells, place = text.split(), f"line {line_number}"
            if not cells:
                continue
            if cells[0][0].isalpha():
                inside = cells == ["Atoms"]
                if inside and comment.strip() not in ("", "sphere"):
                    raise FormatError("atoms must be of style sphere", place)
            elif inside:
                if len(cells) not in (7, 10):  # three numbers of the periodic image may follow
                    raise FormatError(f"has {len(cells)} values, must have id type diameter density x y z", place)
                ids.append(cells[0])
                rows.append(numbers(cells[2:7], _COLUMNS, place))
                places.append(place)
            elif cells[1:] == ["atoms"] and cells[0].isdecimal():
                count = int(cells[0])
            elif len(cells) == 4 and cells[2:] in (["xlo", "xhi"], ["ylo", "yhi"], ["zlo", "zhi"]):
                bounds[cells[2][0]] = numbers(cells[:2], cells[2:], place)
            elif "xy" in cells:
                raise FormatError("the box must not be tilted", place)
    if count is None or "x" not in bounds or len(rows) != count:
        rule = f"must have the headers atoms and xlo xhi, and as many atoms as it says (found {len(rows)})"
        raise FormatError(f"is not a whole LAMMPS data file, {rule}")
    if not rows:
        raise FormatError("has no atoms")
    order = by_id(ids, places)
    diameter, density, x, y, z = np.array(rows)[order].T
    up = heights(y, z)
    low = bounds.get("y" if up is y else "z", [0.0])[0]
    return Table(
        x - bounds["x"][0], up - low, 0.5 * diameter, [places[k] for k in order],
        mass=density * diameter**3, width=bounds["x"][1] - bounds["x"][0],
        periodic=True if title.rstrip().endswith("periodic in x") else None,
    )  # fmt: skip
