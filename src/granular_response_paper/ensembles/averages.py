"""Averages over the realizations at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response.store.variables import RADII
from granular_response_paper.ensembles import smoothed
from granular_response_paper.records import axes, variables


def at_rest(responses: FloatArray, step: int) -> FloatArray:
    """(r, len(x)) responses of the realizations that are at rest at one step."""
    return responses[np.isfinite(responses[:, step, 0]), step]


def averages_dataset(ensembles: xr.Dataset, x: FloatArray, *, widths: Sequence[float], few: int) -> xr.Dataset:
    """Mean smoothed responses with standard errors, and the means of the first ``few`` realizations at rest.

    A standard error needs two realizations, and is nan below.
    """
    cases, steps = ensembles.sizes["case"], ensembles.sizes["step"]
    mean = np.full((len(widths), cases, steps, len(x)), np.nan)
    error, mean_few = mean.copy(), mean.copy()
    count = np.zeros((cases, steps), np.int32)
    for c in range(cases):
        responses = [smoothed(ensembles.isel(case=c), x, width) for width in widths]
        for s in np.flatnonzero(np.isfinite(ensembles["force"].values[c])):
            for w in range(len(widths)):
                rows = at_rest(responses[w], int(s))
                count[c, s] = len(rows)
                if len(rows):
                    mean[w, c, s], mean_few[w, c, s] = rows.mean(axis=0), rows[:few].mean(axis=0)
                if len(rows) > 1:
                    error[w, c, s] = rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
    dims, per = "width case step x", "in 1/mean radius: vertical stress on the floor per applied force"
    data = variables(
        mean=(dims, mean, f"ensemble mean of the smoothed response {per}"),
        standard_error=(dims, error, f"standard error of the mean {per}"),
        mean_of_few=(dims, mean_few, f"mean over the first {few} realizations at rest {per}"),
        count_at_rest=("case step", count, "realizations that are at rest"),
    )
    coordinates = axes(
        width=(widths, f"width w of the smoothing Gaussian {RADII}"), x=(x, f"distance from the loaded disk {RADII}")
    )
    names = ("polydispersity", "friction", "lattice_constant", "realizations")
    kept = {name: ensembles[name].variable for name in names}
    return xr.Dataset(data | {"force": ensembles["force"].variable}, coordinates | kept, {"few": few})
