"""What the slabs of the explorer say in a few numbers: the paper claims nothing of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Of each slab: the largest force that it bears and the response at x = 0 there; the largest unbalanced force."""
    residuals = [np.max(slab["certificate_force_residual"].values) for slab in datasets.values()]
    found = {"max. unbalanced force": float(max(residuals))}
    for slab in datasets.values():
        labels = ("polydispersity", "friction", "stiffness_ratio")
        name = ", ".join(f"{label.replace('_', ' ')} {float(slab[label]):g}" for label in labels)
        found[f"largest force, {name}"] = float(slab["force"].values[-1])
        found[f"response at x = 0, {name}"] = float(slab["response_at_centre"].values[-1])
    return found
