"""What the formats share: forces on disks, the box that holds all states, vectors in the plane of the file."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from ...scene import formats
from ...state import Box, FloatArray, State
from ..result import state_from


def frames(dataset: xr.Dataset, only: int | None = None) -> Iterator[tuple[int, State, FloatArray]]:
    """Index, state and (n, 2) contact forces that its load adds: of all states in order, or of the index ``only``."""
    rest = contact_force_sums(state_from(dataset, 0))
    for index in range(dataset.sizes["state"]) if only is None else [only]:
        state = state_from(dataset, index)
        yield index, state, contact_force_sums(state) - rest


def contact_force_sums(state: State) -> FloatArray:
    """(n, 2) sum of the contact forces on each disk of a state."""
    force, on_pairs = np.zeros_like(state.position), state.pair_force()
    np.add.at(force, state.pairs.first, on_pairs)
    np.add.at(force, state.pairs.second, -on_pairs)
    np.add.at(force, state.walls.first, state.wall_force())
    return force


def mark(dataset: xr.Dataset) -> formats.Mark:
    """What our own tables say of disks and box."""
    bounds = Box.of(dataset.attrs)
    return formats.Mark(dataset.sizes["disk"], bounds.width, bounds.periodic)


def extent(dataset: xr.Dataset) -> tuple[float, float]:
    """Width and height of the box that holds all disks in all states."""
    top = dataset["position"].values[..., 1] + dataset["radius"].values
    return float(dataset.attrs["width"]), float(top.max())


def in_plane(values: FloatArray) -> FloatArray:
    """(n, 3) vectors (x, z, 0) of (n, 2) ones."""
    return np.column_stack([values, np.zeros(len(values))])
