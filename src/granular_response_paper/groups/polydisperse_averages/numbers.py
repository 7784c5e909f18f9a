"""What the ensembles say in a few numbers; claims on disorder are measured on the larger ones of the survey."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Of each case: mean response at x = 0 under the largest force with packings at rest; and these packings in all."""
    averages = datasets["averages"].isel(width=-1)
    middle = int(np.argmin(np.abs(averages["x"].values)))
    found = {"packings at rest": 0.0}
    for case in range(averages.sizes["case"]):
        one = averages.isel(case=case)
        last = int(np.flatnonzero(one["count_at_rest"].values)[-1])
        labels = {"polydispersity": "polydispersity", "friction": "friction", "initial lattice": "lattice_constant"}
        name = ", ".join(f"{label} {one[key].values}" for label, key in labels.items())
        found["packings at rest"] += float(one["count_at_rest"][last])
        found[f"response at x = 0, {name}"] = float(one["mean"][last, middle])
    return found
