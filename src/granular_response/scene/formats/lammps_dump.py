"""LAMMPS dump files of text: the last frame, with columns x y z (also unwrapped or scaled) and radius or diameter.

Disks are in the order of their ids, if there is a column id.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...state import FloatArray
from .table import FormatError, Table, by_id, heights, number, numbers

_AXES = "xyz"


def read(path: Path) -> Table:
    """The disks of the last frame, from the lower corner of its box."""
    with path.open(encoding="utf-8") as stream:
        lines = stream.read().splitlines()
    starts = [k for k, line in enumerate(lines) if line.startswith("ITEM: TIMESTEP")]
    if not starts:
        raise FormatError("is not a LAMMPS dump file of text, must have ITEM: TIMESTEP")
    items: dict[str, int] = {}
    for k in range(starts[-1], len(lines)):
        if lines[k].startswith("ITEM: "):
            for name in ("NUMBER OF ATOMS", "BOX BOUNDS", "ATOMS"):
                if lines[k].startswith(f"ITEM: {name}"):
                    items[name] = k
    try:
        count = int(lines[items["NUMBER OF ATOMS"] + 1])
        box, atoms = items["BOX BOUNDS"], items["ATOMS"]
        rows = [line.split() for line in lines[atoms + 1 : atoms + 1 + count]]
    except (KeyError, IndexError, ValueError):
        raise FormatError("is not a whole LAMMPS dump file: the last frame lacks its number, box or atoms") from None
    if len(rows) != count or not count:
        raise FormatError(f"holds {len(rows)} of {count} atoms in its last frame")
    flags = lines[box].split()[3:]
    if "xy" in flags:
        raise FormatError("the box must not be tilted", f"line {box + 1}")
    bounds = np.array([numbers(lines[box + 1 + a].split()[:2], ("lo", "hi"), f"line {box + 2 + a}") for a in range(3)])
    names = lines[atoms].split()[2:]
    places = [f"line {atoms + 2 + k}" for k in range(count)]
    for cells, place in zip(rows, places, strict=True):
        if len(cells) != len(names):
            raise FormatError(f"has {len(cells)} values, must have {len(names)} as ITEM: ATOMS", place)
    if "id" in names:
        order = by_id([cells[names.index("id")] for cells in rows], places)
        rows, places = [rows[k] for k in order], [places[k] for k in order]

    def column(name: str) -> FloatArray:
        at = names.index(name)
        return np.array([number(cells[at], name, place) for cells, place in zip(rows, places, strict=True)])

    def coordinate(axis: int) -> FloatArray:
        low, high = bounds[axis]
        for name in (_AXES[axis], f"{_AXES[axis]}u"):
            if name in names:
                return column(name) - low
        for name in (f"{_AXES[axis]}s", f"{_AXES[axis]}su"):
            if name in names:
                return (high - low) * column(name)
        raise FormatError(f"column {_AXES[axis]} is missing", f"line {atoms + 1}")

    for name in ("radius", "diameter"):
        if name in names:
            radius = column(name) * (0.5 if name == "diameter" else 1.0)
            break
    else:
        raise FormatError("column radius or diameter is missing", f"line {atoms + 1}")
    mass = column("mass") if "mass" in names else None
    x, y, z = (coordinate(axis) for axis in range(3))
    up = heights(y, z if np.ptp(z) else 0.0 * z)  # where all z are the same, that is anywhere in the box
    periodic = flags[0] == "pp" if flags else None  # old versions write no flags
    return Table(x, up, radius, places, mass, width=float(bounds[0, 1] - bounds[0, 0]), periodic=periodic)
