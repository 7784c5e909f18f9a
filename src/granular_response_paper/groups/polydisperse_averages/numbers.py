"""What the ensembles say in a few numbers; claims on disorder are measured on the larger ones of the survey."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Of each case: packings at rest under the largest force with any, and their mean response at x = 0 there."""
    averages = datasets["averages"].isel(width=-1)
    middle = int(np.argmin(np.abs(averages["x"].values)))
    found = {}
    for case in range(averages.sizes["case"]):
        one = averages.isel(case=case)
        last = int(np.flatnonzero(one["count_at_rest"].values)[-1])
        name = "_".join(f"{one[label].values}" for label in ("polydispersity", "friction", "lattice_constant"))
        found[f"{name}_at_rest"] = float(one["count_at_rest"][last])
        found[f"{name}_response_at_centre"] = float(one["mean"][last, middle])
    return found
