"""A LAMMPS data file with atoms of style sphere in two dimensions.

LAMMPS takes the mass from density and volume of a sphere, so the densities are those that give the stored masses.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr

from .frames import extent, mark


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The file as bytes."""
    state = dataset.isel(state=-1)
    width, height = extent(dataset)
    radius, depth = state["radius"].values, float(state["radius"].values.max())
    density = state["mass"].values / (4.0 / 3.0 * math.pi * radius**3)
    lines = [
        # the format has no place for the sides but its title
        f"LAMMPS data file by {mark(dataset)}; units of mean radius, mean mass and g", "",
        f"{len(radius)} atoms", "1 atom types", "",
        f"0.0 {width!r} xlo xhi", f"0.0 {height!r} ylo yhi", f"{-depth!r} {depth!r} zlo zhi", "",
        "Atoms # sphere", "",
    ]  # fmt: skip
    table = np.column_stack([2.0 * radius, density, state["position"].values, 0.0 * radius]).tolist()
    lines += [f"{k} 1 {' '.join(map(repr, values))}" for k, values in enumerate(table, start=1)]
    return {path: ("\n".join(lines) + "\n").encode("ascii")}
