"""When each event comes in each prepared slab; the claims take these brackets as readings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """First force at which each event has happened (mean disk weights), by event, friction, walls and preparation."""
    found = datasets["events"]
    return {
        f"{found['name'].values[k]}_{found['friction'].values[k]:g}"
        f"_{'rough' if found['wall_friction'].values[k] > 0.0 else 'smooth'}_{found['way'].values[k]}": float(
            found["high"].values[k]
        )
        for k in np.flatnonzero(np.isfinite(found["high"].values)).tolist()
    }
