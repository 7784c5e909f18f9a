"""LAMMPS data files with atoms of style sphere: ``id type diameter density x y z``.

Disks are in the order of their ids. Masses are those that LAMMPS gives such atoms, density times the volume of the
sphere. The format says how large the box is, and not whether its sides are walls or follow the disks; the first line of
our own files does.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .table import (
    FileBox,
    FormatError,
    Mark,
    Once,
    Table,
    bounds,
    by_id,
    lines_of,
    must,
    numbers,
    shown,
    upright,
    upward,
    whole_number,
)

_COLUMNS = ("diameter", "density", "x", "y", "z")
_MOTION = ("vx", "vy", "vz", "wx", "wy", "wz")
_REASON = "a LAMMPS data file does not say what bounds its disks"
_BOUNDS = (("xlo", "xhi"), ("ylo", "yhi"), ("zlo", "zhi"))
#: Edges of a box in newer files, and which of the components must be 0.
_EDGES = ("avec", "bvec", "cvec")
_NUMBERED = ("atom", "bond", "angle", "dihedral", "improper")
#: Headers with a whole number that a file may have.
_COUNTS = {f"{name}s" for name in _NUMBERED} | {f"{name} types" for name in _NUMBERED}
_COUNTS |= {f"extra {name} per atom" for name in (*_NUMBERED, "special")}
#: Sections that may stand beside atoms of style sphere, and the header that says how many lines they have.
_SECTIONS = {"Atoms": "atoms", "Velocities": "atoms", "Masses": "atom types", "Pair Coeffs": "atom types"}
_SECTIONS |= {f"{name.capitalize()}s": f"{name}s" for name in _NUMBERED[1:]}
_SECTIONS |= {f"{name.capitalize()} Coeffs": f"{name} types" for name in _NUMBERED[1:]}
_SECTIONS |= {f"{name.capitalize()} Type Labels": f"{name} types" for name in _NUMBERED}


#: How many values a line may have, and which: three numbers of the periodic image may follow an atom.
_SIZES = {"Atoms": ((7, 10), "id type diameter density x y z"), "Velocities": ((7,), "id vx vy vz wx wy wz")}
#: Sections whose lines begin with what they are about: an atom, or a type.
_NAMED_ONCE = {name for name, header in _SECTIONS.items() if header == "atom types"} | {"Velocities"}


def _header(cells: list[str], place: str) -> tuple[str, Any]:
    """What a line above the sections is about, and what it says. Raises FormatError for one that is no header."""
    count, name = whole_number(cells[0]), " ".join(cells[1:])
    if name in _COUNTS and count is not None:
        return name, count
    ends, values, last = tuple(cells[2:]), cells[:3], cells[3:]
    if ends in _BOUNDS:
        low, high = numbers(cells[:2], ends, place)
        return f"bounds in {ends[0][0]}", bounds(low, high, ends[0][0], place)
    if last == ["xy", "xz", "yz"]:
        upright(numbers(values, last, place), place)
        return "xy xz yz", None
    if last == ["abc", "origin"]:
        return "abc origin", numbers(values, "xyz", place)[0]
    if len(last) == 1 and last[0] in _EDGES:
        k, edge = _EDGES.index(last[0]), numbers(values, "xyz", place)
        upright(edge[:k] + edge[k + 1 :], place)
        return f"bounds in {'xyz'[k]}", bounds(0.0, edge[k], "xyz"[k], place)
    raise FormatError(f"{shown(' '.join(cells))}: is no header of a LAMMPS data file", place)


def read(path: Path) -> Table:
    """The disks of section Atoms."""
    header: dict[str, Any] = {}
    once = Once()
    sections: dict[str, list[tuple[str, list[str]]]] = {}  #: lines of each, with their places
    section = ""
    lines, whole = lines_of(path)
    mark = Mark.found(lines[0][1], "line 1") if lines else None
    for place, line in lines[1:]:
        text, _, comment = line.partition("#")
        cells = text.split()
        if not cells:
            continue
        if cells[0][0].isalpha():
            section = " ".join(cells)
            must(section in _SECTIONS, f"{shown(section)}: is no section that atoms of style sphere have", place)
            once.add(f"section {section}", place)
            sections[section] = []
            if section == "Atoms" and comment.strip() != "sphere":  # other styles have as many columns
                raise FormatError("atoms must be of style sphere, and say so: Atoms # sphere", place)
        elif not section:
            name, said = _header(cells, place)
            once.add(name, place)
            header[name] = said
        else:
            rule = f"{shown(cells[0])}: a line of section {section} must begin with a whole number"
            must(whole_number(cells[0]) is not None, rule, place)
            if section in _NAMED_ONCE:
                once.add(f"{cells[0]} in section {section}", place)
            sections[section].append((place, cells))
    for name, (sizes, names) in _SIZES.items():
        for place, cells in sections.get(name, []):
            must(len(cells) in sizes, f"has {len(cells)} values, must have {names}", place)
    atoms, count = sections.get("Atoms", []), header.get("atoms")
    places = [place for place, _ in atoms]
    rows = [numbers(cells[2:7], _COLUMNS, place) for place, cells in atoms]
    moving = {cells[0]: (place, numbers(cells[1:], _MOTION, place)) for place, cells in sections.get("Velocities", [])}
    rule = f"must have the headers atoms and xlo xhi, and as many atoms as it says (found {len(rows)})"
    must(
        count is not None and "bounds in x" in header and len(rows) == count, f"is not a whole LAMMPS data file, {rule}"
    )
    for name, found in sections.items():
        if len(found) != (said := header.get(_SECTIONS[name], 0)):
            rule = f"must have {said}, as the header {_SECTIONS[name]} says"
            raise FormatError(f"section {name} has {len(found)} lines, {rule}")
    must(rows, "has no atoms")
    most = header.get("atom types", 0)
    for place, (_, kind, *_) in atoms:
        if not 1 <= (whole_number(kind) or 0) <= most and "Atom Type Labels" not in sections:
            raise FormatError(f"type = {shown(kind)}: must be from 1 to {most}, as the header atom types says", place)
    must(whole, "is cut: its last line has no end")
    left, width = header["bounds in x"]
    left += header.get("abc origin", 0.0)  # from which edges are measured
    if mark is not None:
        mark.check(len(rows), whole)
        rule = f"says width {mark.width!r}, the bounds xlo xhi {left!r} to {left + width!r}; must agree"
        must((left, width) == (0.0, mark.width), rule, "line 1")
    ids = [cells[0] for _, cells in atoms]
    known = by_id(ids, places)
    order = list(known.values())
    for atom in moving.keys() - set(ids):
        raise FormatError(f"id = {shown(atom)}: must be that of an atom, section Velocities has it", moving[atom][0])
    diameter, density, x, y, z = np.array(rows)[order].T
    up, columns = upward(y, z), None
    if moving:
        v = np.array([moving[ids[k]][1] for k in order]).T
        columns = {"vx": v[0], "vz": v[1] if up == "y" else v[2], "spin": v[5] if up == "y" else -v[4]}
    box = FileBox(left, width, reason=_REASON) if mark is None else mark.box
    return Table(
        x, z if up == "z" else y, 0.5 * diameter, [places[k] for k in order], density * diameter**3, box,
        columns=columns, ids=list(known),
    )  # fmt: skip
