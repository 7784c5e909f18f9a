"""Text that YADE exports: a line ``x y z r`` for each sphere, or what its comment ``#format x_y_z_r_...`` says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import NO_MASSES, FormatError, Mark, Table, lines_of, numbers, upward

_COLUMNS = ("x", "y", "z", "r")


def read(path: Path) -> Table:
    """The spheres as disks. The format has no box; our own files say theirs in a comment."""
    names: list[str] = list(_COLUMNS)
    rows, places = [], []
    mark: Mark | None = None
    lines, whole = lines_of(path)
    for line_number, line in enumerate(lines, start=1):
        place = f"line {line_number}"
        if line.startswith("#"):
            mark = mark or Mark.found(line, place)
            words = line[1:].split()
            if words[:1] == ["format"] and len(words) == 2:
                names = words[1].split("_")
                if not set(_COLUMNS) <= set(names):
                    raise FormatError("format must have x, y, z and r", place)
            continue
        cells = line.split()
        if not cells:
            continue
        if len(cells) < len(names):
            raise FormatError(f"has {len(cells)} values, must have {' '.join(names)}", place)
        rows.append(numbers([cells[names.index(name)] for name in _COLUMNS], _COLUMNS, place))
        places.append(place)
    if not rows:
        raise FormatError("has no spheres, must have a line x y z r for each")
    if mark is not None:
        mark.check(len(rows), whole)
    x, y, z, radius = np.array(rows).T
    up = z if upward(y, z) == "z" else y
    if mark is None:
        return Table(x, up, radius, places, remark=NO_MASSES)
    return Table(x, up, radius, places, box=mark.box)  # what masses it cannot hold was said when it was written
