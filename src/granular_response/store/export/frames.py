"""What the formats share: forces on disks, the box that holds all states, vectors in the plane of the file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...scene import formats
from ...state import OPEN, Box, FloatArray

PREFIXES = ("contact", "wall")


class Frame(NamedTuple):
    """One state as pictures need it."""

    step: int  #: index of the state in the result
    factor: float  #: load factor
    position: FloatArray  #: (n, 2)
    angle: FloatArray  #: (n,)
    force_change: FloatArray  #: (n, 2) contact forces that the load adds
    coordination: np.ndarray  #: (n,) closed contacts


def frames(dataset: xr.Dataset, only: int | None = None) -> Iterator[Frame]:
    """The states in order, or the one with the index ``only``."""
    rest, _ = contact_force_sums(dataset.isel(state=0))
    for index in range(dataset.sizes["state"]) if only is None else [only]:
        state = dataset.isel(state=index)
        force, count = contact_force_sums(state)
        factor = float(state["state_load_factor"])
        yield Frame(index, factor, state["position"].values, state["angle"].values, force - rest, count)


def contact_force_sums(state: xr.Dataset) -> tuple[FloatArray, np.ndarray]:
    """(n, 2) sum of the contact forces on each disk of one state, and (n,) number of its closed contacts."""
    force, count = np.zeros((state.sizes["disk"], 2)), np.zeros(state.sizes["disk"], int)
    for prefix in PREFIXES:
        acting = state[f"{prefix}_force"].values
        touching = (state[f"{prefix}_status"].values != OPEN).astype(int)
        first = state[f"{prefix}_disk"].values
        np.add.at(force, first, acting)
        np.add.at(count, first, touching)
        if prefix == "contact":
            np.add.at(force, state["contact_partner"].values, -acting)
            np.add.at(count, state["contact_partner"].values, touching)
    return force, count


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
