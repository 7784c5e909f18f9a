"""What the overview shows, in a few numbers: the paper claims nothing of the picture as a whole."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from granular_response.state import OPEN


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Under the largest force: response at x = 0 and opened contacts; and the max. unbalanced force of all states."""
    residuals = [float(slab["certificate_force_residual"].max()) for slab in datasets.values()]
    found = {"max. unbalanced force": max(residuals)}
    for name, slab in datasets.items():
        status = slab["contact_status"].values
        response = np.atleast_2d(slab["floor_response"].values)[-1]
        label = name.replace("_", " ")
        found[f"response at x = 0, {label}"] = float(np.interp(0.0, slab["x"].values, response))
        found[f"opened contacts, {label}"] = float(np.sum((status[0] != OPEN) & (status[-1] == OPEN)))
    return found
