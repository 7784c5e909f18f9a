"""Contacts of given disks with the friction that each bears, so that a packing goes on from where it was at rest.

What is kept of a contact is its tangential force over its normal one. At rest this gives the tangential spring,
whatever the units of the file: the normal force follows from the overlap, and the spring from the contact law.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..state import FLOOR, LEFT_WALL, RIGHT_WALL, FloatArray
from ..state.box import WALL_MEANINGS, wall_normals
from .formats.lammps_dump import WALL_FIXES, read_contacts
from .formats.table import FormatError, Once, Table, lines_of, number, shown, whole_number

if TYPE_CHECKING:
    from .packing import Packing

_NEEDED = ("first", "second", "wall", "normal_force", "tangential_force")


class Row(NamedTuple):
    """A contact: of two disks, or of ``first`` and a wall. Forces act on ``first``, along z × n and the rolling."""

    place: str  #: where it is given
    first: int
    second: int  #: the other disk, or the wall
    at_wall: bool
    normal: float
    tangential: float
    rolling: float  #: nan: not known


@dataclass(frozen=True, eq=False)
class GivenContacts:
    """k contacts that a packing begins with."""

    first: NDArray[np.int64]  #: (k,)
    second: NDArray[np.int64]  #: (k,) the other disk, of a larger number, or the wall
    at_wall: NDArray[np.bool_]
    tangential: FloatArray  #: (k,) force along the tangent over the normal one
    rolling: FloatArray  #: (k,) the same along the rolling; nan where it is not known
    places: Sequence[str]  #: (k,) where each is given, such as "line 7"

    @classmethod
    def of(cls, rows: Iterable[Row], disks: int) -> GivenContacts:
        """Raises FormatError for a contact that is given twice or has no normal force, and a disk that there is not."""
        once, kept = Once(), []
        for row in rows:
            place, first, second, at_wall, normal, tangential, rolling = row
            for disk in (first,) if at_wall else (first, second):
                if not 0 <= disk < disks or (disk == second == first and not at_wall):
                    raise FormatError(f"disk {disk}: must be another one of the {disks} disks, counted from 0", place)
            if first > second and not at_wall:
                first, second, rolling = second, first, -rolling
            once.add(f"contact of {name(first, second, at_wall)}", place)
            if normal < 0.0 or (normal == 0.0 and tangential):
                raise FormatError(f"normal force {normal!r}: must be greater than 0", place)
            part = 1.0 / normal if normal else 0.0
            kept.append((place, first, second, at_wall, tangential * part, rolling * part))
        places, *columns = zip(*kept, strict=True) if kept else [()] * 6
        kinds = (np.int64, np.int64, np.bool_, float, float)
        return cls(*(np.array(column, kind) for column, kind in zip(columns, kinds, strict=True)), places)  # type: ignore


def name(first: int, second: int, at_wall: bool) -> str:
    """A contact in words."""
    return f"disk {first} and the {WALL_MEANINGS[second].replace('_', ' ')}" if at_wall else f"disks {first} and {second}"


def read(path: Path, packing: Packing, table: Table) -> GivenContacts:
    """The contacts of a file: our own table, or a dump of LAMMPS, with those at walls from the ``table`` of disks.

    Raises FormatError for what cannot be read, OSError and UnicodeError.
    """
    lines, whole = lines_of(path)
    if lines and lines[0].startswith("ITEM:"):
        rows = [*_of_pairs(path, packing, table), *_of_walls(table)]
    else:
        if not whole:
            raise FormatError("is cut: its last line has no end")
        rows = list(_of_table(lines))
    return GivenContacts.of(rows, packing.n)


def _of_table(lines: list[str]) -> Iterator[Row]:
    header: list[str] = []
    for k, cells in enumerate(csv.reader(lines), start=1):
        place = f"line {k}"
        if not header:
            header = cells
            if missing := [one for one in _NEEDED if header.count(one) != 1]:
                raise FormatError(f"must be a table as .contacts.csv with one column {', '.join(missing)}", place)
            continue
        if len(cells) != len(header):
            raise FormatError(f"has {len(cells)} values, must have {len(header)} as the header", place)
        row = dict(zip(header, cells, strict=True))
        if row["wall"] and row["wall"] not in WALL_MEANINGS:
            raise FormatError(f"wall = {shown(row['wall'])}: must be {' or '.join(WALL_MEANINGS)}, or empty", place)
        disks = [whole_number(row[one].strip()) for one in ("first", "second")[: 1 if row["wall"] else 2]]
        if None in disks:
            raise FormatError("first and second: must be numbers of disks, counted from 0", place)
        second = WALL_MEANINGS.index(row["wall"]) if row["wall"] else disks[1]
        forces = [number(row.get(one, "0"), one, place) for one in (*_NEEDED[3:], "rolling_force")]
        yield Row(place, disks[0] or 0, second or 0, bool(row["wall"]), *forces)


def _of_pairs(path: Path, packing: Packing, table: Table) -> Iterator[Row]:
    if table.ids is None:
        raise FormatError("is a dump that calls disks by their ids, so the file of the disks must have ids")
    known = {one: k for k, one in enumerate(table.ids)}
    for (one, two, normal, *force), place in zip(*read_contacts(path), strict=True):
        if one not in known or two not in known:
            raise FormatError(f"atoms {one:.0f} and {two:.0f}: must be ids of disks in the other file", place)
        first, second = known[int(one)], known[int(two)]
        apart = packing.box.separation(packing.position[first], packing.position[second])
        across = float(-apart[1] * force[0] + apart[0] * (force[1] + force[2])) / float(np.hypot(*apart))
        yield Row(place, first, second, False, normal, across, np.nan)


def _of_walls(table: Table) -> Iterator[Row]:
    columns: Mapping[str, FloatArray] = table.columns or {}
    for fix in WALL_FIXES:
        if {f"{fix} x", f"{fix} z"} <= columns.keys():
            x, z = columns[f"{fix} x"], columns[f"{fix} z"]
            for k in np.flatnonzero((x != 0.0) | (z != 0.0)).tolist():
                wall = FLOOR if fix == WALL_FIXES[0] else LEFT_WALL if x[k] > 0.0 else RIGHT_WALL
                (nx, nz), place = wall_normals([wall])[0], f"{table.places[k]} of the disks"
                yield Row(place, k, wall, True, float(nx * x[k] + nz * z[k]), float(nx * z[k] - nz * x[k]), np.nan)
