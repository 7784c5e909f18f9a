"""Text that YADE exports: a line ``x y z r`` for each sphere, or what its comment ``#format x_y_z_r_...`` says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .table import NO_MASSES, FormatError, Mark, Once, Table, lines_of, numbers, shown, upward

_COLUMNS = ("x", "y", "z", "r")
#: The last name of a format of YADE that stands for as many values as its user asked for.
_ANY = "attrs"


def read(path: Path) -> Table:
    """The spheres as disks. The format has no box; our own files say theirs in a comment."""
    names: list[str] = list(_COLUMNS)
    rows: list[list[float]] = []
    places: list[str] = []
    mark: Mark | None = None
    last: Mark | None = None
    once = Once()
    values = 0  #: in each line, where the format leaves their number open
    lines, whole = lines_of(path)
    for place, line in lines:
        if line.lstrip().startswith("#"):
            if (found := Mark.found(line, place)) and Mark.ends(line):
                once.add("last line of granular-response", place)
                last = found
            elif found:
                once.add("mark of granular-response", place)
                mark = found
            words = line.split()
            if words[0] == "#format" or (words[:2] == ["#", "format"] and len(words) == 3):
                once.add("#format", place)
                names = _names(line, place, bool(rows))
            continue
        cells = line.split()
        if not cells:
            continue
        expected = len(names)
        if names[-1] == _ANY:
            values = expected = values or max(len(cells), len(names))
        if len(cells) != expected:
            raise FormatError(f"has {len(cells)} values, must have {' '.join(names)}", place)
        rows.append(numbers([cells[names.index(name)] for name in _COLUMNS], _COLUMNS, place))
        places.append(place)
    if not rows:
        raise FormatError("has no spheres, must have a line x y z r for each")
    if last is not None and last != mark:
        above = "is missing or damaged" if mark is None else "says something else"
        raise FormatError(f"the mark of granular-response in its last line is there, that above the spheres {above}")
    if mark is not None:
        mark.check(len(rows), whole)
    x, y, z, radius = np.array(rows).T
    up = z if upward(y, z) == "z" else y
    if mark is None:
        return Table(x, up, radius, places, remark=NO_MASSES)
    return Table(x, up, radius, places, box=mark.box)  # what masses it cannot hold was said when it was written


def _names(line: str, place: str, late: bool) -> list[str]:
    names = line.replace("#", " ", 1).split()[1:]
    if late or len(names) != 1:
        raise FormatError("format must be one word such as x_y_z_r, above the spheres", place)
    names = names[0].split("_")
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            raise FormatError(f"format names {shown(name)} {names.count(name)} times, must name it once", place)
    if not set(_COLUMNS) <= set(names):
        raise FormatError("format must have x, y, z and r", place)
    return names
