"""A LAMMPS dump file of text: one frame for each state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from .frames import box, extent, frames, in_plane


def files(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """The file as bytes, of all states or the one with the index ``only``."""
    width, height = extent(dataset)
    radius, mass = dataset["radius"].values, dataset["mass"].values
    depth = float(radius.max())
    sides = "pp" if box(dataset).periodic else "ff"
    lines = []
    for frame in frames(dataset, only):
        lines += ["ITEM: TIMESTEP", str(frame.step), "ITEM: NUMBER OF ATOMS", str(len(radius))]
        lines += [f"ITEM: BOX BOUNDS {sides} ff pp", f"0.0 {width!r}", f"0.0 {height!r}", f"{-depth!r} {depth!r}"]
        lines.append("ITEM: ATOMS id type x y z radius mass fx fy fz")
        columns = [in_plane(frame.position), radius, mass, in_plane(frame.force_change)]
        table = np.column_stack(columns).tolist()
        lines += [f"{k} 1 {' '.join(map(repr, row))}" for k, row in enumerate(table, start=1)]
    return {path: ("\n".join(lines) + "\n").encode("ascii")}
