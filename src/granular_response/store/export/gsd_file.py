"""GSD, the format of HOOMD, for OVITO: one frame for each state, contacts as bonds.

Coordinates are (x, z, 0), measured from the lower left corner. The format puts the middle of its box at the origin, so
the box is twice as wide and high as the packing and holds disks between walls in its upper right quarter (those beside
periodic sides may stand beyond them); the log entries
``origin``, ``box_width`` and ``periodic`` say so.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from .. import atomic
from .frames import extent, frames, in_plane


def files(dataset: xr.Dataset, path: Path, only: int | None = None) -> dict[Path, bytes]:
    """The file as bytes, of all states or the one with the index ``only``."""
    import gsd.hoomd

    with atomic.scratch() as folder:  # the library writes to disk only
        made = folder / "export.gsd"
        with gsd.hoomd.open(str(made), "w") as file:
            width, height = extent(dataset)
            for index, state, force_change in frames(dataset, only):
                frame = gsd.hoomd.Frame()
                frame.configuration.step = index
                frame.configuration.dimensions = 2
                frame.configuration.box = [2.0 * width, 2.0 * height, 0, 0, 0, 0]
                frame.particles.N = dataset.sizes["disk"]
                frame.particles.types = ["disk"]
                frame.particles.position = in_plane(state.position)
                frame.particles.diameter = 2.0 * dataset["radius"].values
                frame.particles.mass = dataset["mass"].values
                half = 0.5 * state.angle
                frame.particles.orientation = np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
                pairs, touching = state.pairs, state.pairs.touching
                frame.bonds.N = np.count_nonzero(touching)
                frame.bonds.types = ["contact"]
                frame.bonds.group = np.column_stack([pairs.first, pairs.second])[touching]
                frame.log = {
                    "origin": np.zeros(3),
                    "box_width": np.array([width]),
                    "periodic": np.array([state.box.periodic], np.uint8),
                    "load_factor": np.array([state.load_factor]),
                    "particles/force_change": in_plane(force_change),
                    "particles/coordination": state.contact_count().astype(np.int32),
                    "bonds/normal_force": pairs.normal_force[touching],
                    "bonds/tangential_force": pairs.tangential_force[touching],
                }
                file.append(frame)
        return {path: made.read_bytes()}
