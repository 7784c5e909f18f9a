"""The closed contacts of a state as a table: a row for each, with what a reader asks for in words."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ..scene.laboratory import FORCE, LENGTH
from ..state import FloatArray, State
from ..state.box import WALL_MEANINGS
from ..state.state import MEANINGS

#: Units of the columns that have one.
UNITS = {"x": LENGTH, "z": LENGTH, "normal_force": FORCE, "tangential_force": FORCE}


def contact_table(state: State, radius: FloatArray) -> Any:
    """A ``pandas.DataFrame`` of the contacts of disks with ``radius`` (n,), those between disks first."""
    pairs, walls = state.pairs, state.walls
    between, at_wall = pairs.touching, walls.touching
    middle = (radius[pairs.first] - 0.5 * pairs.overlap)[:, None] * state.pair_normal()
    point = np.concatenate(
        [
            (state.position[pairs.first] - middle)[between],
            state.box.on_wall(state.position[walls.first], walls.second)[at_wall],
        ]
    )

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(pairs, name)[between], getattr(walls, name)[at_wall]])

    columns = {
        "first": joined("first"),
        "second": np.concatenate([pairs.second[between], np.full(at_wall.sum(), -1, np.int32)]),
        "wall": np.array([""] * between.sum() + [WALL_MEANINGS[k] for k in walls.second[at_wall]], object),
        "x": point[:, 0],
        "z": point[:, 1],
        "status": np.array([MEANINGS[code] for code in joined("status")], object),
        "normal_force": joined("normal_force"),
        "tangential_force": joined("tangential_force"),
    }
    units = dict(UNITS)
    if pairs.resists_rolling or walls.resists_rolling:
        columns["rolling_force"], units["rolling_force"] = joined("rolling_force"), FORCE
        columns["rolling_status"] = np.array([MEANINGS[code] for code in joined("rolling_status")], object)
    found = xr.Dataset({name: ("contact", values) for name, values in columns.items()}).to_dataframe()
    found.attrs["units"] = units
    return found
