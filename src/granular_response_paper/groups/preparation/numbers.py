"""When each event comes in each prepared slab; the claims take these brackets as readings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

#: The events that an experiment moves: where linearity ends, and one peak becomes two.
EVENTS = ("linear_range", "crossover")


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Ends of the linear range and crossover forces (mean disk weights), by friction, walls and preparation."""
    found = datasets["events"]
    return {
        f"{found['name'].values[k].replace('_', ' ')}, friction {found['friction'].values[k]:g}, "
        f"{'rough' if found['wall_friction'].values[k] > 0.0 else 'smooth'} walls, {found['way'].values[k]}": float(
            found["high"].values[k]
        )
        for k in np.flatnonzero(np.isfinite(found["high"].values)).tolist()
        if found["name"].values[k] in EVENTS
    }
