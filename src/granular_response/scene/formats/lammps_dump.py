"""LAMMPS dump files of text: the last frame, with columns x y z (also unwrapped or scaled) and radius or diameter.

The format has neither an end nor a number of frames: a file that was cut between two frames is whole, and what is read
of it is the last frame that it has. ``Table.frame`` says which one that is.

Disks are in the order of their ids, if there is a column id. Sizes and masses may be columns of the atoms or what a
compute, a fix or a variable calls by their name: ``mass``, ``c_mass``, ``v_mass[1]``. Velocities, spins and the forces
of walls are read where there are columns of them. A dump of local quantities has contacts in place of atoms.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...state import FloatArray
from ..names import WALL_FIXES
from .table import (
    NO_MASSES,
    FileBox,
    FormatError,
    Table,
    agree,
    bounds,
    by_id,
    lines_of,
    listed,
    must,
    number,
    numbers,
    radii,
    shown,
    upright,
    upward,
    whole_number,
)

_AXES = "xyz"
_CONTACT = ("patom1", "patom2", "force", "p1", "p2", "p3")
#: Items of a frame, and how many lines each has. Beside them are the number of its atoms, or entries, and these.
_ITEMS = {"UNITS": 1, "TIME": 1, "TIMESTEP": 1, "BOX BOUNDS": 3}


class _Item(NamedTuple):
    """An item of a frame: where its heading stands, the words after its name, and its lines with their places."""

    place: str
    words: list[str]
    lines: list[tuple[str, str]]


def _frames(lines: list[tuple[str, str]], rows: str = "ATOMS") -> list[dict[str, _Item]]:
    """All frames by their items. Raises FormatError for a line that belongs to none, and for an item given twice."""
    known = (*_ITEMS, f"NUMBER OF {rows}", rows)
    frames: list[dict[str, _Item]] = [{}]
    item: _Item | None = None
    for place, line in lines:
        if not line.strip():
            continue
        if not line.startswith("ITEM:"):
            if item is None:
                raise FormatError("is not a LAMMPS dump file of text, must begin with ITEM: TIMESTEP")
            item.lines.append((place, line))
            continue
        heading = line[len("ITEM:") :].strip()
        name = max((name for name in known if f"{heading} ".startswith(f"{name} ")), key=len, default=None)
        if name is None:
            local = ", but of contacts, which packing.springs takes" if heading == "NUMBER OF ENTRIES" else ""
            raise FormatError(f"ITEM: {shown(heading)[1:-1]}: is no item of a dump of {rows.lower()}{local}", place)
        frame = frames[-1]
        # units and time stand above the number of the step, which begins a frame
        if rows in frame and "BOX BOUNDS" in frame and name in ("UNITS", "TIME", "TIMESTEP"):
            frames.append(frame := {})
        if name in frame:
            raise FormatError(f"ITEM: {name}: is given twice in a frame, in {frame[name].place} and here", place)
        frame[name] = item = _Item(place, heading[len(name) :].split(), [])
    return frames


def _checked(frame: dict[str, _Item], which: str, rows: str = "ATOMS") -> int:
    """The number of atoms of a frame, once it is whole: every item is there with its lines and no other.

    A frame may have none, as the first ones of a packing that is poured.
    """
    number_of, what = f"NUMBER OF {rows}", rows.lower()
    needed = ["TIMESTEP", number_of, "BOX BOUNDS", rows]
    if missing := [name for name in needed if name not in frame]:
        must(missing != needed, "is not a LAMMPS dump file of text, must have ITEM: TIMESTEP")
        raise FormatError(f"is not a whole LAMMPS dump file: the {which} lacks its number, box or {what}")
    for name, expected in {**_ITEMS, number_of: 1}.items():
        if name not in frame:
            continue
        item = frame[name]
        if len(item.lines) != expected:
            lines = "one line" if expected == 1 else "three lines of bounds"
            if name == "BOX BOUNDS":
                lines += ", and have flags of three axes or none"
            raise FormatError(f"must be followed by {lines}, not {len(item.lines)}", item.place)
    for name, counted in (("TIMESTEP", "the time step"), (number_of, what)):
        place, text = frame[name].lines[0]
        if (count := whole_number(text.strip())) is None:
            raise FormatError(f"{shown(text)}: must be the number of {counted}", place)
    if (found := len(frame[rows].lines)) != count:
        raise FormatError(f"holds {found} of {count} {what} in its {which}", frame[rows].place)
    return count


def _last_frame(path: Path, rows: str = "ATOMS") -> tuple[dict[str, _Item], str]:
    """The last frame of a file, once all are whole, and which one it is."""
    lines, whole = lines_of(path)
    frames = _frames(lines, rows)
    for k, one in enumerate(frames, start=1):
        count = _checked(one, "last frame" if k == len(frames) else f"frame {k} of {len(frames)}", rows)
    must(whole, "is cut: its last line has no end")
    must(count, f"holds 0 of 0 {rows.lower()} in its last frame", frames[-1][rows].place)
    frame, last = frames[-1], len(frames)
    return frame, f"{last} of {last}, time step {frame['TIMESTEP'].lines[0][1].strip()}"


def read_contacts(path: Path) -> list[tuple[list[float], str]]:
    """Rows ``id id force p1 p2 p3`` of the contacts in the last frame of a dump of local quantities, with their places.

    The first two are ``patom1 patom2`` of ``compute property/local``, the others what ``compute pair/local`` has.
    """
    entries = _last_frame(path, "ENTRIES")[0]["ENTRIES"]
    rule = f"must have the six columns {' '.join(_CONTACT)}, not {len(entries.words)}"
    must(len(entries.words) == len(_CONTACT), rule, entries.place)
    return [(numbers(line.split(), _CONTACT, place), place) for place, line in entries.lines]


def read(path: Path) -> Table:
    """The disks of the last frame."""
    frame, which = _last_frame(path)
    flags, sides = _box(frame["BOX BOUNDS"])
    atoms = frame["ATOMS"]
    names, heading = atoms.words, atoms.place
    for name in names:
        if names.count(name) > 1:
            several = [str(k) for k, other in enumerate(names, start=1) if other == name]
            given = f"is given {len(several)} times, as columns {' and '.join(several)}; must be given once"
            raise FormatError(f"column {shown(name)[1:-1]} {given}", heading)
    rows = [line.split() for _, line in atoms.lines]
    places = [place for place, _ in atoms.lines]
    for cells, place in zip(rows, places, strict=True):
        must(len(cells) == len(names), f"has {len(cells)} values, must have {len(names)} as ITEM: ATOMS", place)
    ids = None
    if "id" in names:
        known = by_id([cells[names.index("id")] for cells in rows], places)
        ids, rows, places = list(known), [rows[k] for k in known.values()], [places[k] for k in known.values()]

    def column(at: int) -> FloatArray:
        return np.array([number(cells[at], names[at], place) for cells, place in zip(rows, places, strict=True)])

    def coordinate(axis: int) -> FloatArray:
        low, size = sides[axis]
        found: dict[str, FloatArray] = {}
        for ending, scaled in (("", False), ("u", False), ("s", True), ("su", True)):
            if (name := _AXES[axis] + ending) in names:
                values = column(names.index(name))
                found[name] = low + size * values if scaled else values
        must(found, f"column {_AXES[axis]} is missing; there are {listed(names)}", heading)
        (first, values), *others = found.items()
        for name, other in others:
            agree((first, name), values, other, places, size if flags[axis : axis + 1] == ["pp"] else 0.0)
        return values

    def quantity(*words: str) -> FloatArray | None:
        found = [k for k, name in enumerate(names) if _plain(name) in words]
        if len(found) > 1:
            several = ", ".join(shown(names[k]) for k in found)
            raise FormatError(f"columns {several}: must have one of them", heading)
        return column(found[0]) if found else None

    sizes = {name: values for name in ("radius", "diameter") if (values := quantity(name)) is not None}
    must(sizes, f"column radius or diameter is missing; there are {listed(names)}", heading)
    radius = radii(sizes, places)
    mass, density = quantity("mass", "rmass"), quantity("density")
    must(mass is None or density is None, "columns mass and density: must have one of them", heading)
    if density is not None:
        mass = density * (2.0 * radius) ** 3  # of a sphere, as LAMMPS has it
    x, y, z = (coordinate(axis) for axis in range(3))
    up = upward(y, z if np.ptp(z) else 0.0 * z)  # where all z are the same, that is anywhere in the box
    bounded = _file_box(flags, sides, _AXES.index(up))
    extra = {name: column(names.index(name)) for name in _further(up) if name in names}
    columns = {said: sign * extra[name] for name, (said, sign) in _further(up).items() if name in extra}
    remark = NO_MASSES if mass is None else ""
    return Table(x, y if up == "y" else z, radius, places, mass, bounded, remark, columns or None, ids, which)


def _further(up: str) -> dict[str, tuple[str, float]]:
    """Columns that are read where they are: what each is in the plane of the disks, and its sign there."""
    along = {"x": "[2]", "z": "[3]" if up == "y" else "[4]"}
    walls = {f"f_{wall}{at}": (f"{wall} {axis}", 1.0) for wall in WALL_FIXES for axis, at in along.items()}
    spin = {"omegaz": ("spin", 1.0)} if up == "y" else {"omegay": ("spin", -1.0)}
    return {"vx": ("vx", 1.0), f"v{up}": ("vz", 1.0), **spin, **walls}


def _plain(name: str) -> str:
    """The name of a column without what says where it comes from."""
    return re.sub(r"^(?:c|f|v|i|d)2?_|(?:\[\d+\])+$", "", name).casefold()


def _box(item: _Item) -> tuple[list[str], list[tuple[float, float]]]:
    """Flags of the three axes, if there are any, and along each where the box begins and how far it reaches.

    Tilted boxes have three numbers a line, those of newer versions an edge and a component of the origin.
    """
    words, names = item.words, ["lo", "hi"]
    edges = words[:2] == ["abc", "origin"]
    if edges:
        names, words = [*_AXES, "origin"], words[2:]
    elif words[:3] == ["xy", "xz", "yz"]:
        names, words = ["lo", "hi", "tilt"], words[3:]
    rule = "must be followed by three lines of bounds, and have flags of three axes or none"
    must(len(words) in (0, 3) and all(re.fullmatch("[pfsm]{2}", word) for word in words), rule, item.place)
    sides = []
    for axis, (place, line) in enumerate(item.lines):
        values = numbers(line.split(), names, place)
        if edges:
            upright(values[:axis] + values[axis + 1 : 3], place)
            values = [values[3], values[3] + values[axis]]
        upright(values[2:], place)
        sides.append(bounds(values[0], values[1], _AXES[axis], place))
    return words, sides


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
