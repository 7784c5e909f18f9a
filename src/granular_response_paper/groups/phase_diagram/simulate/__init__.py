"""The force at which one peak becomes two, against friction and disorder: Fig. 22, claims on disordered slabs.

The paper's figure is a sketch; here it is measured on the load paths of the survey (``data/survey/``), the lattice
among them, so nothing is simulated. What counts as two peaks, and what a crossover is, stands in
:mod:`granular_response_paper.survey.crossover`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import COLLAPSED, smoothed
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.groups.phase_diagram.simulate.starts import CASE, dips_of_few, side_by_side, starts_of
from granular_response_paper.records import axes, parts, places, table, variables
from granular_response_paper.survey import crossover
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import LEVELS, Crossing, Ensemble, Singles, folded
from granular_response_paper.tasks import computed

APPLIED = f"applied force {WEIGHTS}"


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """What the survey says of every case.

    Datasets ``crossovers``, one entry for each case; ``definitions``, the same by other tolerances, and ``medians``, of
    the median realization; ``shapes``, the shape against the force; ``realizations``, one by one; ``packings`` at rest;
    ``starts`` side by side; ``linear_range``, the response under small forces beside smooth walls, and its change.

    Raises StoreError if the survey cannot be read, ValueError if a parameter is out of range.
    """
    asked = parameters
    x = np.arange(round(asked.reach / asked.spacing) + 1, dtype=float) * asked.spacing
    stored = survey.read(Path(asked.survey), asked.blocks)
    source, packings = stored["ensembles"], stored["packings"]
    compared = starts_of(source, packings, asked)
    tasks = {}
    for (w, case), (width, _) in places(asked.widths, range(source.sizes["case"])):
        steps = {k: start.step for k, start in enumerate(compared) if start.case == case}
        tasks[w, case] = partial(of_case, read_ensemble(source, case, x, width, asked), asked, steps)
    done = computed(tasks, "crossovers")
    crossings, single = ({k: one[0] for k, one in done.items()}, {k: one[1] for k, one in done.items()})
    few = {(w, k): dips for (w, _), one in done.items() for k, dips in one[2].items()}
    found = _datasets(source, asked, crossings, single)
    found["packings"] = packings
    found["starts"] = side_by_side(compared, few, found["shapes"], max(asked.numbers))
    small = survey.read(Path(asked.survey), [asked.linear_range])["ensembles"]
    found["linear_range"] = _linear_range(small, asked.linear_width, np.concatenate([-x[:0:-1], x]))
    return labelled(found)


def of_case(
    ensemble: Ensemble, asked: Parameters, steps: Mapping[int, int]
) -> tuple[Crossing, Singles, dict[int, FloatArray]]:
    """The crossover of an ensemble, its realizations one by one, and the dips of few of them at some ``steps``."""
    drawn = {"draws": asked.draws, "seed": asked.seed}
    symmetric = replace(ensemble, response=folded(ensemble.response))
    crossing = crossover.cross(symmetric, number=min(asked.numbers), others=asked.other_tolerances, **drawn)
    few = {k: dips_of_few(symmetric, step, asked) for k, step in steps.items()}
    return crossing, crossover.singles(ensemble, **drawn), few


def read_ensemble(source: xr.Dataset, case: int, x: FloatArray, width: float, asked: Parameters) -> Ensemble:
    """The realizations of a case, smoothed, from the left end of the reach to the right; ``x`` is the right half."""
    one = source.isel(case=case, realization=slice(0, int(source["realizations"][case])))
    used = np.isfinite(one["force"].values)
    response = smoothed(one.isel(step=used), np.concatenate([-x[:0:-1], x]), width)
    least = max(1, int(np.ceil(asked.least_part * len(response))))
    return Ensemble(one["force"].values[used], response, x, width, least, asked.tolerance)


def _linear_range(source: xr.Dataset, width: float, x: FloatArray) -> xr.Dataset:
    profiles = np.stack([smoothed(source.isel(case=case), x, width) for case in range(source.sizes["case"])])
    small = profiles[:, :, :1]
    change = np.linalg.norm(profiles - small, axis=-1) / np.linalg.norm(small, axis=-1)
    centre = "smoothed response at x = 0 in 1/mean radius: stress per applied force"
    off = "root mean square change of the smoothed response from that to the smallest force, relative to it"
    data = variables(
        response_at_centre=("case realization step", profiles[..., np.argmin(np.abs(x))], centre),
        profile_change=("case realization step", change, off),
        applied_force=("case step", source["force"].values, APPLIED),
    )
    return xr.Dataset(data, {name: source[name].variable for name in CASE}, {"width": width})


def _datasets(
    source: xr.Dataset, parameters: Parameters, crossings: Mapping[Any, Crossing], single: Mapping[Any, Singles]
) -> dict[str, xr.Dataset]:
    """``crossovers``, ``definitions``, ``shapes``, ``realizations`` and ``medians``, by width and case."""
    along = ("width", "case")
    of_mean, of_each = table(crossings, *along), table(single, *along)
    by_tolerance = table(parts(crossings, "others"), *along, "tolerance", kind=crossover.Crossover)
    medians = table({place: single[place].middle(*one.limits) for place, one in crossings.items()}, *along)
    for data in (of_mean, by_tolerance, medians):
        data["draws"] = data["draws"].astype(np.float32)
    for name in ("shape", "asymmetry", "difference"):
        of_each[name] = of_each[name].astype(np.float32)

    crossovers = of_mean[["force", "kind", "interval", "draws", "limits", "seen", "seen_interval"]]
    force = variables(applied_force=("case step", source["force"].values, APPLIED))
    spread = of_each[["spread", "spread_interval", "largest_step", "largest_step_interval"]].variables
    shapes = xr.Dataset(force | dict(of_mean[["shape", "shape_interval"]].variables) | dict(spread))
    realizations = of_each[["shape", "asymmetry", "difference", "median"]]
    gone = np.where(source["outcome"].values == COLLAPSED, source["force"].values[:, None], np.nan)
    collapse = np.fmin.reduce(gone, axis=-1)
    collapsed = f"force under which the packing collapsed {WEIGHTS}; nan for none"

    coordinates = axes(
        width=(parameters.widths, f"width w of the smoothing Gaussian {RADII}"),
        level=(LEVELS, "part of the bootstrap draws below"),
    ) | {name: source[name].variable for name in CASE}
    tolerance = {"tolerance": parameters.tolerance}
    tolerances = axes(tolerance=(parameters.other_tolerances, "shape from which on there are two peaks"))
    found = {
        "crossovers": (crossovers.assign_attrs(tolerance), {}),
        "definitions": (by_tolerance.assign(limits=crossovers["limits"].variable), tolerances),
        "shapes": (shapes.assign_attrs(tolerance), {}),
        "realizations": (realizations.assign(variables(collapse_force=("case realization", collapse, collapsed))), {}),
        "medians": (medians.assign(limits=crossovers["limits"].variable).assign_attrs(tolerance), {}),
    }
    return {name: data.assign_coords(coordinates | own) for name, (data, own) in found.items()}
