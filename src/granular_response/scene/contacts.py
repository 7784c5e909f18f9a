"""Contacts of given disks with the friction that each bears, so that a packing goes on from where it was at rest.

What is kept of a contact is its tangential force over its normal one. At rest this gives the tangential spring,
whatever the units of the file: the normal force follows from the overlap, and the spring from the contact law.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..state import FLOOR, LEFT_WALL, RIGHT_WALL, Box, FloatArray
from ..state.box import WALL_MEANINGS, bodies, wall_normals
from .errors import suggestion
from .formats.lammps_dump import read_contacts
from .formats.table import FormatError, Once, Table, lines_of, listed, must, number, shown, whole_number
from .names import WALL_FIXES

_NAMES, _FORCES, _ROLLING = ("first", "second", "wall"), ("normal_force", "tangential_force"), "rolling_force"
#: All columns of a table of contacts.
_COLUMNS = (*_NAMES, *_FORCES, _ROLLING, "x", "z", "status", "rolling_status")


class GivenContact(NamedTuple):
    """A contact that a packing begins with: of two disks, or of ``first`` and a wall."""

    place: str  #: where it is given, such as "line 7"
    first: int
    second: int  #: the other disk, of a larger number, or the wall
    at_wall: bool
    tangential: float  #: force on ``first`` along z × n, over the normal one
    rolling: float  #: the same along the rolling; nan: not known
    normal: float = 1.0  #: what the two are over

    @property
    def words(self) -> str:
        return bodies(self.first, self.second, self.at_wall)


def checked(contacts: Iterable[GivenContact], disks: int) -> tuple[GivenContact, ...]:
    """The contacts with the smaller number first, and forces over the normal one.

    Raises FormatError for one that is given twice or has no normal force, and a disk that there is not.
    """
    once, found = Once(), []
    for one in contacts:
        for disk in (one.first,) if one.at_wall else (one.first, one.second):
            if not 0 <= disk < disks or (one.first == one.second and not one.at_wall):
                raise FormatError(f"disk {disk}: must be another one of the {disks} disks, counted from 0", one.place)
        if one.normal < 0.0 or (one.normal == 0.0 and one.tangential):
            raise FormatError(f"normal force {one.normal!r}: must be greater than 0", one.place)
        part = 1.0 / (one.normal or 1.0)
        one = one._replace(tangential=one.tangential * part, rolling=one.rolling * part)
        if not one.at_wall and one.first > one.second:
            one = one._replace(first=one.second, second=one.first, rolling=-one.rolling)
        once.add(f"contact of {one.words}", one.place)
        found.append(one)
    return tuple(found)


def read(path: Path, position: FloatArray, box: Box, table: Table) -> tuple[GivenContact, ...]:
    """The contacts of a file: our own table, or a dump of LAMMPS, with those at walls from the ``table`` of disks.

    ``position`` (n, 2) and ``box`` are those of the packing. Raises FormatError, OSError and UnicodeError.
    """
    lines, whole = lines_of(path)
    if lines and lines[0][1].startswith("ITEM:"):
        return checked([*_of_pairs(path, position, box, table), *_of_walls(table)], len(position))
    must(whole, "is cut: its last line has no end")
    return checked(_of_table([line for _, line in lines]), len(position))


def _of_table(lines: list[str]) -> Iterator[GivenContact]:
    header = [one.strip() for one in next(csv.reader(lines), [])]
    for name in header:
        if name in (*_NAMES, *_FORCES, _ROLLING) and header.count(name) > 1:
            raise FormatError(f"column {name} is given {header.count(name)} times, must be given once", "line 1")
        if name not in _COLUMNS and (meant := suggestion(name.casefold(), _COLUMNS)):
            raise FormatError(f"column {shown(name)[1:-1]}: unknown{meant}", "line 1")
    if missing := [one for one in (*_NAMES, *_FORCES) if one not in header]:
        there = f"; there are {listed(header)}" if len(missing) < len((*_NAMES, *_FORCES)) else ""
        several = f"columns {', '.join(missing)} are" if len(missing) > 1 else f"column {missing[0]} is"
        raise FormatError(f"{several} missing, which a .contacts.csv has{there}", "line 1")
    for place, cells in ((f"line {k}", cells) for k, cells in enumerate(csv.reader(lines), start=1) if k > 1):
        must(len(cells) == len(header), f"has {len(cells)} values, must have {len(header)} as the header", place)
        row = dict(zip(header, cells, strict=True))
        first, second, wall = (row[one].strip() for one in _NAMES)
        if wall and wall not in WALL_MEANINGS:
            raise FormatError(f"wall = {shown(wall)}: must be {' or '.join(WALL_MEANINGS)}, or empty", place)
        one, other = whole_number(first), WALL_MEANINGS.index(wall) if wall else whole_number(second)
        if one is None or other is None:
            raise FormatError("first and second: must be numbers of disks, counted from 0", place)
        normal, tangential = (number(row[name], name, place) for name in _FORCES)
        rolling = number(row[_ROLLING], _ROLLING, place) if _ROLLING in row else np.nan
        yield GivenContact(place, one, other, bool(wall), tangential, rolling, normal)


def _of_pairs(path: Path, position: FloatArray, box: Box, table: Table) -> Iterator[GivenContact]:
    if table.ids is None:
        raise FormatError("calls disks by their ids, so the file of the disks must have ids")
    known = {float(one): k for k, one in enumerate(table.ids)}
    for (one, two, normal, x, y, z), place in read_contacts(path):
        must(one in known and two in known, f"atoms {one:.0f} and {two:.0f}: must be ids of disks", place)
        apart = box.separation(position[known[one]], position[known[two]])
        tangential = float(apart[0] * (y + z) - apart[1] * x) / float(np.hypot(*apart))
        yield GivenContact(place, known[one], known[two], False, tangential, np.nan, normal)


def _of_walls(table: Table) -> Iterator[GivenContact]:
    columns = table.columns or {}
    for fix in (one for one in WALL_FIXES if {f"{one} x", f"{one} z"} <= columns.keys()):
        x, z = columns[f"{fix} x"], columns[f"{fix} z"]
        for k in np.flatnonzero((x != 0.0) | (z != 0.0)).tolist():
            wall = FLOOR if fix == "floor" else LEFT_WALL if x[k] > 0.0 else RIGHT_WALL
            nx, nz = wall_normals([wall])[0]
            normal, tangential = float(nx * x[k] + nz * z[k]), float(nx * z[k] - nz * x[k])
            yield GivenContact(f"{table.places[k]} of the disks", k, wall, True, tangential, np.nan, normal)
