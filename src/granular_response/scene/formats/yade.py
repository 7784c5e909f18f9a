"""Text that YADE exports: a line ``x y z r`` for each sphere, or what its comment ``#format x_y_z_r_...`` says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import FormatError, Table, heights, numbers

_COLUMNS = ("x", "y", "z", "r")


def read(path: Path) -> Table:
    """The spheres as disks. The file has no box."""
    names: list[str] = list(_COLUMNS)
    rows, places = [], []
    with path.open(encoding="utf-8") as stream:
        for line_number, line in enumerate(stream, start=1):
            place = f"line {line_number}"
            if line.startswith("#"):
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
    x, y, z, radius = np.array(rows).T
    return Table(x, heights(y, z), radius, places)
