"""The force at which one peak becomes two, against friction and disorder: Fig. 22, claims on disordered slabs.

The paper's figure is a sketch; here it is measured on the load paths of the survey (``survey/``), the lattice
among them, so nothing is simulated. What counts as two peaks, and what a crossover is, stands in
:mod:`granular_response_paper.survey.crossover`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.resources import current
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import COLLAPSED, smoothed
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.survey import crossover
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import CONFIDENCE, LEVELS, Crossing, Ensemble, Singles, folded

#: A width of the Gaussian and a case.
Place = tuple[int, int]

#: Coordinates of a case.
CASE = ("polydispersity", "friction", "wall_friction", "lattice_constant", "realizations")


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """What the survey says of every case.

    Datasets ``crossovers``, one entry for each case; ``definitions``, the same by other tolerances, and ``medians``, of
    the median realization; ``shapes``, the shape against the force; ``realizations``, one by one; ``packings`` at rest;
    ``starts`` side by side; ``linear_range``, the response under small forces beside smooth walls, and its change.

    Raises StoreError if the survey cannot be read, ValueError if a parameter is out of range.
    """
    asked, widths = parameters, parameters.widths
    x = np.arange(round(asked.reach / asked.spacing) + 1, dtype=float) * asked.spacing
    stored = survey.read(Path(asked.survey), asked.blocks)
    source, packings = stored["ensembles"], stored["packings"]
    places = list(product(range(len(widths)), range(source.sizes["case"])))
    drawn: dict[str, Any] = {"draws": asked.draws, "seed": asked.seed, "tolerance": asked.tolerance}
    crossings, single = {}, {}
    for done, (w, case) in enumerate(places, 1):
        ensemble = read_ensemble(source, case, x, widths[w], asked.least_part)
        symmetric = Ensemble(ensemble.force, folded(ensemble.response), ensemble.least)
        crossings[w, case] = crossover.cross(
            symmetric, x, widths[w], numbers=asked.numbers, others=asked.other_tolerances, **drawn
        )
        single[w, case] = crossover.singles(ensemble, x, widths[w], **drawn)
        if progress := current().progress:
            progress(done, len(places), "crossovers")
    found = _datasets(source, asked, crossings, single)
    collapsed = (source["outcome"].values == COLLAPSED).any(axis=-1).sum(axis=-1).astype(np.int32)
    text = "packings that collapse along their load paths"
    found["medians"] = found["medians"].assign(variables(collapsed=("case", collapsed, text)))
    found["packings"] = packings.drop_vars("processor_time", errors="ignore")
    found["starts"] = _starts(source, asked, found["shapes"], packings, x)
    small = survey.read(Path(asked.survey), [asked.linear_range])["ensembles"]
    found["linear_range"] = _linear_range(small, asked.linear_width, np.concatenate([-x[:0:-1], x]))
    return labelled(found)


def read_ensemble(source: xr.Dataset, case: int, x: FloatArray, width: float, least_part: float) -> Ensemble:
    """The realizations of a case, smoothed, from the left end of the reach to the right; ``x`` is the right half."""
    one = source.isel(case=case, realization=slice(0, int(source["realizations"][case])))
    used = np.isfinite(one["force"].values)
    response = smoothed(one.isel(step=used), np.concatenate([-x[:0:-1], x]), width)
    return Ensemble(one["force"].values[used], response, max(1, int(np.ceil(least_part * len(response)))))


_BOOTSTRAPPED = "quantiles of the bootstrapped mean"
_APPLIED = f"applied force {WEIGHTS}"


@record
class Start:
    """What touches at rest in the packings of one start, and under which force the response is compared."""

    applied_force: float = column(_APPLIED)
    distance: float = column(f"distance of neighbours before gravity acts {RADII}")
    contacts: float = column("mean number of contacts of a disk at rest, walls counted")
    contacts_interval: FloatArray = column(_BOOTSTRAPPED, "level")
    missing_horizontal: float = column("horizontal part of the contacts that the lattice has and the packing has not")
    missing_horizontal_interval: FloatArray = column(_BOOTSTRAPPED, "level")

    @classmethod
    def of(cls, force: float, distance: float, packing: xr.Dataset, lattice: xr.Dataset, drawn: FloatArray) -> Start:
        """``drawn`` (draw, realization) is how often each packing counts in a draw; ``lattice`` is a packing."""
        kinds = ("horizontal_contacts", "oblique_contacts")
        horizontal, oblique = (float(lattice[kind].values) - packing[kind].values for kind in kinds)
        numbers: list[Any] = []
        for values in (packing["coordination_number_with_walls"].values, horizontal / (horizontal + oblique)):
            means = drawn @ values / len(values)
            numbers += [values.mean(), np.quantile(means, LEVELS)]
        return cls(force, distance, *numbers)


def _starts(
    source: xr.Dataset, parameters: Parameters, shapes: xr.Dataset, packings: xr.Dataset, x: FloatArray
) -> xr.Dataset:
    """Every start of a polydispersity under one force: its dip, and what touches at rest."""
    places, starts = [], []
    lattice = packings.isel(case=0, realization=0)
    constant = packings["lattice_constant"].values
    for one in parameters.compared:
        alike = np.isclose(source["polydispersity"].values, one.polydispersity)
        under = np.isclose(source["force"].values, one.force)
        for case in np.flatnonzero(alike & under.any(axis=1)).tolist():
            usual = constant[case] == constant[0]
            distance = 2.0 / (1.0 - 0.5 * one.polydispersity) if usual else float(constant[case])
            count = int(packings["realizations"].values[case])
            packing = packings.isel(case=case, realization=slice(0, count))
            drawn = crossover.weights(count, parameters.draws, parameters.seed)
            starts.append(Start.of(one.force, distance, packing, lattice, drawn))
            places.append((case, int(np.flatnonzero(under[case])[0])))
    order, steps = (xr.DataArray(list(each), dims="case") for each in zip(*places, strict=True))
    at_force = shapes[["shape", "shape_interval"]].isel(case=order, step=steps)
    return xr.Dataset(
        {
            "dip": at_force["shape"].variable,
            "dip_interval": at_force["shape_interval"].variable,
            **dict(table(starts, "case").variables),
        },
        coords={
            **{name: source[name].isel(case=order).variable for name in CASE},
            **{name: shapes[name].variable for name in ("width", "level")},
        },
    ).assign(_means_of_few(source, parameters, x, places))


def _means_of_few(
    source: xr.Dataset, parameters: Parameters, x: FloatArray, places: Sequence[tuple[int, int]]
) -> dict[str, xr.Variable]:
    """How far means of the largest of ``numbers`` realizations dip at x = 0, for some cases and steps of the force."""
    number, quantiles = max(parameters.numbers), []
    for width, (case, step) in product(parameters.widths, places):
        rows = folded(read_ensemble(source, case, x, width, parameters.least_part).response[:, step])
        rows = rows[np.isfinite(rows[:, 0])]
        shapes = crossover.shapes_of_samples(rows, x, width, number, seed=parameters.seed)
        ends = np.quantile(np.quantile(shapes, LEVELS, axis=1), CONFIDENCE, axis=1).T
        quantiles.append(np.column_stack([np.quantile(shapes, LEVELS), ends]))
    every = np.reshape(quantiles, (len(parameters.widths), len(places), len(LEVELS), 3))
    text = f"quantiles of the shape of the means of {number} realizations, drawn at random"
    of_ends = "ends of 95 % of these quantiles over draws of the realizations"
    return variables(
        dip_of_means=("width case level", every[..., 0], text),
        dip_of_means_interval=("width case level end", every[..., 1:], of_ends),
    )


def _linear_range(source: xr.Dataset, width: float, x: FloatArray) -> xr.Dataset:
    profiles = np.stack([smoothed(source.isel(case=case), x, width) for case in range(source.sizes["case"])])
    small = profiles[:, :, :1]
    change = np.linalg.norm(profiles - small, axis=-1) / np.linalg.norm(small, axis=-1)
    centre = "smoothed response at x = 0 in 1/mean radius: stress per applied force"
    off = "root mean square change of the smoothed response from that to the smallest force, relative to it"
    data = variables(
        response_at_centre=("case realization step", profiles[..., np.argmin(np.abs(x))], centre),
        profile_change=("case realization step", change, off),
        applied_force=("case step", source["force"].values, _APPLIED),
    )
    return xr.Dataset(data, {name: source[name].variable for name in CASE}, {"width": width})


def _datasets(
    source: xr.Dataset, parameters: Parameters, crossings: Mapping[Place, Crossing], single: Mapping[Place, Singles]
) -> dict[str, xr.Dataset]:
    """``crossovers``, ``definitions``, ``shapes``, ``realizations`` and ``medians``."""
    places = ("width", "case")
    of_mean, of_each = table(crossings, *places), table(single, *places)
    others = {(*place, k): other for place, one in crossings.items() for k, other in enumerate(one.others)}
    by_tolerance = table(others, *places, "tolerance", kind=crossover.Crossover)
    medians = table({place: single[place].middle(*one.limits) for place, one in crossings.items()}, *places)
    for data in (of_mean, by_tolerance, medians):
        data["draws"] = data["draws"].astype(np.float32)
    for name in ("shape", "asymmetry", "difference"):
        of_each[name] = of_each[name].astype(np.float32)
    of_each["kind"] = of_each["kind"].copy(data=np.nan_to_num(of_each["kind"].values, nan=-1).astype(np.int8))

    crossovers = of_mean[["force", "kind", "interval", "draw_part", "draws", "limits", "seen", "seen_interval"]]
    force = variables(applied_force=("case step", source["force"].values, _APPLIED))
    spread = of_each[["spread", "spread_interval", "largest_step", "largest_step_interval"]].variables
    shapes = xr.Dataset(force | dict(of_mean[["shape", "shape_interval", "two_peaked_means"]].variables) | dict(spread))
    realizations = of_each[["shape", "asymmetry", "difference", "crossover", "kind", "median", "median_interval"]]
    gone = np.where(source["outcome"].values == COLLAPSED, source["force"].values[:, None], np.nan)
    collapse = np.fmin.reduce(gone, axis=-1)
    collapsed = f"force under which the packing collapsed {WEIGHTS}; nan for none"

    coordinates = axes(
        width=(parameters.widths, f"width w of the smoothing Gaussian {RADII}"),
        level=(LEVELS, "part of the bootstrap draws below"),
    ) | {name: source[name].variable for name in CASE}
    tolerance = {"tolerance": parameters.tolerance}
    kinds = axes(kind_of_draw=(crossover.KINDS, "kinds of bootstrap draws"))
    tolerances = axes(tolerance=(parameters.other_tolerances, "shape from which on there are two peaks"))
    found = {
        "crossovers": (crossovers.assign_attrs(tolerance), kinds),
        "definitions": (by_tolerance.assign(limits=crossovers["limits"].variable), tolerances),
        "shapes": (shapes.assign_attrs(tolerance), axes(number=(parameters.numbers, "realizations in a mean"))),
        "realizations": (realizations.assign(variables(collapse_force=("case realization", collapse, collapsed))), {}),
        "medians": (medians.assign(limits=crossovers["limits"].variable).assign_attrs(tolerance), {}),
    }
    return {name: data.assign_coords(coordinates | own) for name, (data, own) in found.items()}
