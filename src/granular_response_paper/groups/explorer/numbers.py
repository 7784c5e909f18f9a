"""What the slabs of the explorer say in a few numbers: the paper claims nothing of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Of each slab: the largest force that it bears, the response at x = 0 there, and the largest unbalanced force."""
    return {
        f"{name}_{what}": float(value)
        for name, slab in datasets.items()
        for what, value in (
            ("largest_force", slab["force"].values[-1]),
            ("response_at_centre", slab["response_at_centre"].values[-1]),
            ("force_residual", np.max(slab["certificate_force_residual"].values)),
        )
    }
