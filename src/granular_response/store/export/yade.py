"""Text in YADE's columns ``x y z r``: disks as spheres in the plane y = 0."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from .frames import mark


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The file as bytes."""
    state = dataset.isel(state=-1)
    x, z = state["position"].values.T
    rows = np.column_stack([x, np.zeros_like(x), z, state["radius"].values]).tolist()
    lines = ["#format x_y_z_r", f"# {mark(dataset)}", *(" ".join(map(repr, row)) for row in rows)]
    return {path: ("\n".join(lines) + "\n").encode("ascii")}
