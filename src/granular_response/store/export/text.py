"""Files of text, every digit kept: disks for LAMMPS, OVITO (extended XYZ) and as CSV, contacts and events as CSV.

LAMMPS takes the mass of a sphere from density and volume, so the densities of its data files are those that give the
stored masses.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple
from pathlib import Path

import numpy as np
import xarray as xr

from ...state import Box
from ..result import contact_table, events_from, state_from
from ..variables import EVENTS
from .frames import extent, frames, in_plane, mark


def _file(path: Path, lines: Iterable[str]) -> dict[Path, bytes]:
    return {path: ("\n".join(lines) + "\n").encode("ascii")}


def _rows(columns: Sequence[np.ndarray], between: str = " ") -> list[str]:
    return [between.join(map(repr, row)) for row in np.column_stack(columns).tolist()]


def csv_table(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The disks in the columns that ``packing: {kind: file}`` reads."""
    state = dataset.isel(state=-1)
    rows = _rows([state["position"].values, state["radius"].values, state["mass"].values], ",")
    head = f"# {mark(dataset)}, load factor {float(state['state_load_factor'])!r}"
    return _file(path, [head, "x,z,radius,mass", *rows])


def lammps_data(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The disks as atoms of style sphere in two dimensions, with their velocities where some disk moves."""
    state = dataset.isel(state=-1)
    width, height = extent(dataset)
    radius, depth = state["radius"].values, float(state["radius"].values.max())
    density = state["mass"].values / (4.0 / 3.0 * math.pi * radius**3)
    head = [
        # the format has no place for the sides but its title
        f"LAMMPS data file by {mark(dataset)}; units of mean radius, mean mass and g", "",
        f"{len(radius)} atoms", "1 atom types", "",
        f"0.0 {width!r} xlo xhi", f"0.0 {height!r} ylo yhi", f"{-depth!r} {depth!r} zlo zhi", "",
        "Atoms # sphere", "",
    ]  # fmt: skip
    rows = _rows([2.0 * radius, density, in_plane(state["position"].values)])
    lines = [*head, *(f"{k} 1 {row}" for k, row in enumerate(rows, start=1))]
    velocity, spin = state["velocity"].values, state["angular_velocity"].values
    if velocity.any() or spin.any():
        rows = _rows([in_plane(velocity), np.zeros((len(spin), 2)), spin])
        lines += ["", "Velocities # sphere", "", *(f"{k} {row}" for k, row in enumerate(rows, start=1))]
    return _file(path, lines)


def lammps_dump(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """A frame for each state, or the one with the index ``only``."""
    width, height = extent(dataset)
    radius, mass = dataset["radius"].values, dataset["mass"].values
    depth = float(radius.max())
    sides = "pp" if Box.of(dataset.attrs).periodic else "ff"
    lines = []
    for step, state, force_change in frames(dataset, only):
        lines += ["ITEM: TIMESTEP", str(step), "ITEM: NUMBER OF ATOMS", str(len(radius))]
        lines += [f"ITEM: BOX BOUNDS {sides} ff pp", f"0.0 {width!r}", f"0.0 {height!r}", f"{-depth!r} {depth!r}"]
        lines.append("ITEM: ATOMS id type x y z radius mass c_force_change[1] c_force_change[2] c_force_change[3]")
        rows = _rows([in_plane(state.position), radius, mass, in_plane(force_change)])
        lines += [f"{k} 1 {row}" for k, row in enumerate(rows, start=1)]
    return _file(path, lines)


def xyz(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """A frame of extended XYZ for each state, or the one with the index ``only``."""
    width, height = extent(dataset)
    columns = "species:S:1:pos:R:3:radius:R:1:mass:R:1:angle:R:1:force_change:R:3:coordination:I:1"
    radius, mass = dataset["radius"].values, dataset["mass"].values
    depth = 2.0 * float(radius.max())
    periodic = "T" if Box.of(dataset.attrs).periodic else "F"
    lines = []
    for _, state, force_change in frames(dataset, only):
        lines.append(str(len(radius)))
        lines.append(
            f'Lattice="{width!r} 0.0 0.0 0.0 {height!r} 0.0 0.0 0.0 {depth!r}" Properties={columns} '
            f'load_factor={state.load_factor!r} pbc="{periodic} F F"'
        )
        rows = _rows([in_plane(state.position), radius, mass, state.angle, in_plane(force_change)])
        lines += [f"X {row} {count}" for row, count in zip(rows, state.contact_count(), strict=True)]
    return _file(path, lines)


def contacts(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The closed contacts of the last state, a line each."""
    table = contact_table(state_from(dataset, -1), dataset["radius"].values)
    return {path: table.to_csv().encode("ascii")}


def events(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """The events of the load path, a line each: all, or those on the way to the state with the index ``only``."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["state", *EVENTS])
    table.writerows([state, *astuple(event)] for state, event in events_from(dataset, only))
    return {path: text.getvalue().encode("utf-8")}
