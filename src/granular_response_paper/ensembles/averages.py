"""Averages over the realizations at rest, single realizations beside them, and linear ranges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response.observe.floor import smoothed_response
from granular_response.state import FloatArray
from granular_response.store.result import FORCE, LENGTH, variable
from granular_response_paper.ensembles import AT_REST, OUTCOMES, smoothed
from granular_response_paper.ensembles.realizations import LOADED, Realization
from granular_response_paper.groups.polydisperse_averages.parameters import Individual


def _at_rest(responses: FloatArray, step: int) -> FloatArray:
    """(r, len(x)) responses of the realizations that are at rest at one step."""
    return responses[np.isfinite(responses[:, step, 0]), step]


def averages_dataset(ensembles: xr.Dataset, x: FloatArray, *, widths: Sequence[float], few: int) -> xr.Dataset:
    """Mean smoothed responses with standard errors, and the means of the first ``few`` realizations at rest.

    A standard error needs two realizations, and is nan below.
    """
    cases, steps = ensembles.sizes["case"], ensembles.sizes["step"]
    mean = np.full((len(widths), cases, steps, len(x)), np.nan)
    error, mean_few = mean.copy(), mean.copy()
    count = np.zeros((len(OUTCOMES), cases, steps), np.int32)
    for c in range(cases):
        outcome = ensembles["outcome"].values[c, : int(ensembles["realizations"][c])]
        responses = [smoothed(ensembles.isel(case=c), x, width) for width in widths]
        for s in np.flatnonzero(np.isfinite(ensembles["force"].values[c])):
            count[:, c, s] = np.bincount(outcome[:, s], minlength=len(OUTCOMES))
            for w in range(len(widths)):
                rows = _at_rest(responses[w], int(s))
                if len(rows):
                    mean[w, c, s], mean_few[w, c, s] = rows.mean(axis=0), rows[:few].mean(axis=0)
                if len(rows) > 1:
                    error[w, c, s] = rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
    dims = ("width", "case", "step", "x")
    per = "in 1/mean radius: vertical stress on the floor per applied force"
    return xr.Dataset(
        {
            "mean": variable(dims, mean, f"ensemble mean of the smoothed response {per}"),
            "standard_error": variable(dims, error, f"standard error of the mean {per}"),
            "mean_of_few": variable(dims, mean_few, f"mean over the first {few} realizations at rest {per}"),
            **{
                f"count_{name}": variable(("case", "step"), count[k], f"realizations that are {name.replace('_', ' ')}")
                for k, name in enumerate(OUTCOMES)
            },
            "force": ensembles["force"].variable,
        },
        coords={
            "width": variable("width", widths, f"width w of the smoothing Gaussian {LENGTH}"),
            "x": variable("x", x, f"distance from the loaded disk {LENGTH}"),
            **{name: ensembles[name].variable for name in ("polydispersity", "friction", "lattice_constant")},
        },
        attrs={"few": few},
    )


def individual_dataset(ensembles: xr.Dataset, shown: Individual, x: FloatArray) -> xr.Dataset:
    """Fig. 19: smoothed responses of single realizations at one force, of every start that has a case.

    nan where there are fewer realizations at rest than asked for.
    """
    force, most, width = shown.force, shown.realizations, shown.width
    alike = ensembles["polydispersity"].values == shown.polydispersity
    alike &= np.isin(ensembles["friction"].values, shown.frictions)
    cases = np.flatnonzero(alike & (ensembles["force"].values == force).any(axis=1))
    response = np.full((len(cases), most, len(x)), np.nan)
    for k, case in enumerate(cases):
        step = int(np.flatnonzero(ensembles["force"].values[case] == force)[0])
        rows = _at_rest(smoothed(ensembles.isel(case=int(case)), x, width), step)[:most]
        response[k, : len(rows)] = rows
    return xr.Dataset(
        {
            "response": variable(
                ("case", "realization", "x"), response, "smoothed response in 1/mean radius: stress per applied force"
            ),
            "force": variable((), force, f"applied force {FORCE}"),
            "width": variable((), width, f"width w of the smoothing Gaussian {LENGTH}"),
        },
        coords={
            "x": variable("x", x, f"distance from the loaded disk {LENGTH}"),
            **{
                name: ensembles[name].isel(case=cases).variable
                for name in ("polydispersity", "friction", "lattice_constant")
            },
        },
    )


def linear_range_dataset(
    grid: Sequence[tuple[float, float]],
    forces: Sequence[float],
    found: Sequence[Realization],
    width: float,
    tolerance: float,
) -> xr.Dataset:
    """Smoothed response at x = 0 against the force, one packing each, and where it ceases to be constant."""
    centre = np.full((len(grid), len(forces)), np.nan)
    end = np.full((len(grid), 2), np.nan)
    for k, one in enumerate(found):
        for s in np.flatnonzero(one.outcome == AT_REST):
            centre[k, s] = smoothed_response([0.0], one.x, one.response[s], width)[0]
        end[k] = linear_end(np.asarray(forces), centre[k], tolerance)
    dims = ("path", "force")
    below = f"differs by less than {tolerance:.0%} from that to the smallest force"
    return xr.Dataset(
        {
            "response_at_centre": variable(
                dims, centre, "smoothed response at x = 0 in 1/mean radius: stress per applied force"
            ),
            "outcome": variable(dims, np.stack([one.outcome for one in found]), "what became of the packing"),
            "by_motion": variable(dims, np.stack([one.loaded["by_motion"] for one in found]), LOADED["by_motion"]),
            "linear_until": variable("path", end[:, 0], f"last force {FORCE} at which the response {below}"),
            "nonlinear_from": variable("path", end[:, 1], f"first force {FORCE} at which it does not; nan for none"),
        },
        coords={
            "polydispersity": variable("path", [delta for delta, _ in grid], "delta: spread of the radii"),
            "friction": variable("path", [mu for _, mu in grid], "coefficient of friction, walls frictionless"),
            "force": variable("force", forces, f"applied force {FORCE}"),
        },
        attrs={"width": width, "tolerance": tolerance},
    )


def linear_end(force: FloatArray, response: FloatArray, tolerance: float) -> tuple[float, float]:
    """Forces between which ``response`` first leaves the neighbourhood of its first value.

    Last force before and first force after; the latter is nan if it never leaves.
    """
    away = np.flatnonzero(np.abs(response / response[0] - 1.0) > tolerance)
    if not away.size:
        known = np.flatnonzero(np.isfinite(response))
        return (float(force[known[-1]]) if known.size else float("nan")), float("nan")
    return float(force[away[0] - 1]), float(force[away[0]])
