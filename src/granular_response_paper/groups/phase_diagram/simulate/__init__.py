"""The force at which one peak becomes two, against friction and disorder: Fig. 22, claims on disordered slabs.

The paper's figure is a sketch; here it is measured on the load paths of the survey (``data/survey/``), the lattice
among them, so nothing is simulated. What counts as two peaks, and what a crossover is, stands in
:mod:`granular_response_paper.survey.crossover`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.scene.lattice import touching_largest
from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import COLLAPSED, smoothed
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.records import axes, column, parts, places, record, stacked, table, variables
from granular_response_paper.survey import crossover
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import (
    CONFIDENCE,
    LEVELS,
    Crossing,
    Ensemble,
    Singles,
    folded,
    shapes_of_samples,
    weights,
)
from granular_response_paper.survey.datasets import PREPARED
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


#: Coordinates of a case.
CASE = (*PREPARED, "realizations")
CONTACTS = ("horizontal_contacts", "oblique_contacts")
_BOOTSTRAPPED = "quantiles of the bootstrapped mean"


@record
class Start:
    """What touches at rest in the packings of one start, and under which force the response is compared."""

    case: int
    step: int  #: of the force
    applied_force: float = column(f"applied force {WEIGHTS}")
    distance: float = column(f"distance of neighbours before gravity acts {RADII}")
    contacts: float = column("mean number of contacts of a disk at rest, walls counted")
    contacts_interval: FloatArray = column(_BOOTSTRAPPED, "level")
    missing_horizontal: float = column("horizontal part of the contacts that the lattice has and the packing has not")
    missing_horizontal_interval: FloatArray = column(_BOOTSTRAPPED, "level")


def starts_of(source: xr.Dataset, packings: xr.Dataset, asked: Parameters) -> list[Start]:
    """Every start of a polydispersity under the force at which they are compared.

    Raises ValueError if the first case is not the lattice, or no case has one of the polydispersities and its force.
    """
    if source["polydispersity"].values[0] > 0.0:
        raise ValueError(f"blocks = {list(asked.blocks)}: must begin with one of the lattice")
    found: list[Start] = []
    lattice, constant = packings.isel(case=0, realization=0), packings["lattice_constant"].values
    for one in asked.compared:
        alike = np.isclose(source["polydispersity"].values, one.polydispersity) & (source["gravity_ramp"].values == "")
        places = np.argwhere(alike[:, None] & np.isclose(source["force"].values, one.force)).tolist()
        if not places:
            had = f"polydispersity {one.polydispersity:g} and a force of {one.force:g}"
            raise ValueError(f"compared: no case of blocks = {list(asked.blocks)} has {had}")
        for case, step in places:
            usual = constant[case] == constant[0]
            distance = touching_largest(one.polydispersity) if usual else float(constant[case])
            packing = packings.isel(case=case, realization=slice(0, int(packings["realizations"].values[case])))
            horizontal, oblique = (float(lattice[kind].values) - packing[kind].values for kind in CONTACTS)
            contacts, part = packing["coordination_number_with_walls"].values, horizontal / (horizontal + oblique)
            drawn = weights(len(part), asked.draws, asked.seed)
            ends = [np.quantile(drawn @ values / len(values), LEVELS) for values in (contacts, part)]
            found.append(Start(case, step, one.force, distance, contacts.mean(), ends[0], part.mean(), ends[1]))
    return found


def dips_of_few(symmetric: Ensemble, step: int, asked: Parameters) -> FloatArray:
    """(level, 3) shapes of means of the largest of ``numbers`` realizations: quantiles, and the ends of their 95 %."""
    shapes = shapes_of_samples(symmetric, step, max(asked.numbers), seed=asked.seed)
    ends = np.quantile(np.quantile(shapes, LEVELS, axis=1), CONFIDENCE, axis=1).T
    return np.column_stack([np.quantile(shapes, LEVELS), ends])


def side_by_side(
    found: Sequence[Start], few: Mapping[tuple[int, int], FloatArray], shapes: xr.Dataset, number: int
) -> xr.Dataset:
    """The starts with their dips; ``few`` (width, start) are those of means of a ``number`` of realizations."""
    case, step = (xr.DataArray([getattr(one, name) for one in found], dims="case") for name in ("case", "step"))
    dips = shapes.isel(case=case, step=step).rename(shape="dip", shape_interval="dip_interval")
    own = {name: dips[name].variable for name in ("dip", "dip_interval")} | dict(table(found, "case").variables)
    text = f"quantiles of the shape of the means of {number} realizations, drawn at random"
    every, of_ends = stacked(few), "ends of 95 % of these quantiles over draws of the realizations"
    further = variables(
        dip_of_means=("width case level", every[..., 0], text),
        dip_of_means_interval=("width case level end", every[..., 1:], of_ends),
    )
    return xr.Dataset(own, {name: dips[name].variable for name in (*CASE, "width", "level")}).assign(further)
