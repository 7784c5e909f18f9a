"""When each event comes in each prepared slab between smooth walls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

#: The events that an experiment moves: where linearity ends, and one peak becomes two.
EVENTS = ("linear_range", "crossover")


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Ends of the linear range and crossover forces (mean disk weights), by friction and preparation."""
    found = datasets["events"]
    columns = ("name", "friction", "wall_friction", "way", "high")
    rows = zip(*(found[key].values.tolist() for key in columns), strict=True)
    return {
        f"{name.replace('_', ' ')}, friction {friction:g}, smooth walls, {way}": high
        for name, friction, wall_friction, way, high in rows
        if name in EVENTS and not wall_friction and np.isfinite(high)
    }
