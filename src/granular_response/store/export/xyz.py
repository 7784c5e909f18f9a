"""Extended XYZ for OVITO: one frame for each state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from .frames import box, extent, frames, in_plane


def files(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """The file as bytes, of all states or the one with the index ``only``."""
    width, height = extent(dataset)
    columns = "species:S:1:pos:R:3:radius:R:1:mass:R:1:angle:R:1:force_change:R:3:coordination:I:1"
    radius, mass = dataset["radius"].values, dataset["mass"].values
    depth = 2.0 * float(radius.max())
    periodic = "T" if box(dataset).periodic else "F"
    lines = []
    for _, factor, position, angle, force, count in frames(dataset, only):
        lines.append(str(len(position)))
        lines.append(
            f'Lattice="{width!r} 0.0 0.0 0.0 {height!r} 0.0 0.0 0.0 {depth!r}" Properties={columns} '
            f'load_factor={factor!r} pbc="{periodic} F F"'
        )
        table = np.column_stack([in_plane(position), radius, mass, angle, in_plane(force)])
        for values, contacts in zip(table.tolist(), count.tolist(), strict=True):
            lines.append(" ".join(["X", *map(repr, values), str(contacts)]))
    return {path: ("\n".join(lines) + "\n").encode("ascii")}
