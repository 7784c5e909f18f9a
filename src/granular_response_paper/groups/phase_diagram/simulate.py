"""The force at which one peak becomes two, against friction and disorder: Fig. 22, claims on disordered slabs.

The paper's figure is a sketch; here it is measured on the load paths of the survey (``survey/``), the lattice
among them, so nothing is simulated. What counts as two peaks, and what a crossover is, stands in
:mod:`granular_response_paper.survey.crossover`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.state import FloatArray
from granular_response.store.result import FORCE, LENGTH, flags, variable
from granular_response.sweeps.resources import current
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import COLLAPSED, smoothed
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.survey import datasets as survey
from granular_response_paper.survey.crossover import (
    ABOVE,
    BELOW,
    FOUND,
    KINDS,
    LEVELS,
    Crossing,
    Ensemble,
    Singles,
    cross,
    folded,
    part_of_samples,
    quantiles,
    singles,
    weights,
)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """What the survey says of every case.

    Datasets ``crossovers``, one entry for each case; ``definitions``, the same by other tolerances, and ``medians``, of
    the median realization; ``shapes``, the shape against the force; ``realizations``, one by one; ``packings`` at rest;
    ``starts`` side by side; ``linear_range``, the response under small forces beside smooth walls, and its change.

    Raises
    ------
    granular_response.store.files.StoreError
        If the survey cannot be read.
    ValueError
        If a parameter is out of range.
    """
    draws, seed, tolerance = parameters.draws, parameters.seed, parameters.tolerance
    spacing, widths = parameters.spacing, parameters.widths
    x = np.arange(round(parameters.reach / spacing) + 1, dtype=float) * spacing
    stored = survey.read(Path(parameters.survey), parameters.blocks)
    source = stored["ensembles"]
    cases = source.sizes["case"]
    table: list[list[Crossing]] = []
    single: list[list[Singles]] = []
    for row, width in enumerate(widths):
        table.append([])
        single.append([])
        for case in range(cases):
            ensemble = read_ensemble(source, case, x, width, parameters.least_part)
            symmetric = Ensemble(ensemble.force, folded(ensemble.response), ensemble.least)
            table[-1].append(
                cross(
                    symmetric,
                    x,
                    width,
                    numbers=parameters.numbers,
                    draws=draws,
                    seed=seed,
                    tolerance=tolerance,
                    others=parameters.other_tolerances,
                )
            )
            single[-1].append(singles(ensemble, x, width, draws=draws, seed=seed, tolerance=tolerance))
            if progress := current().progress:
                progress(row * cases + case + 1, len(widths) * cases, "crossovers")
    found = _datasets(source, parameters, table, single)
    collapsed = (source["outcome"].values == COLLAPSED).any(axis=-1).sum(axis=-1).astype(np.int32)
    found["medians"] = _medians(found["crossovers"], single, collapsed)
    packings = stored["packings"]
    found["packings"] = packings[[name for name in packings.data_vars if str(name) != "processor_time"]]
    found["starts"] = _starts(source, parameters, found["shapes"], packings)
    small = survey.read(Path(parameters.survey), [parameters.linear_range])["ensembles"]
    both_sides = np.concatenate([-x[:0:-1], x])
    found["linear_range"] = _linear_range(small, parameters.linear_width, both_sides)
    found["starts"] = found["starts"].assign(_means_of_few(found["starts"], source, parameters, x))
    return labelled(found)


def read_ensemble(source: xr.Dataset, case: int, x: FloatArray, width: float, least_part: float) -> Ensemble:
    """The realizations of a case, smoothed, from the left end of the reach to the right; ``x`` is the right half."""
    one = source.isel(case=case, realization=slice(0, int(source["realizations"][case])))
    used = np.isfinite(one["force"].values)
    response = smoothed(one.isel(step=used), np.concatenate([-x[:0:-1], x]), width)
    return Ensemble(one["force"].values[used], response, max(1, int(np.ceil(least_part * len(response)))))


def _medians(usual: xr.Dataset, table: Sequence[Sequence[Singles]], collapsed: NDArray[np.int32]) -> xr.Dataset:
    """What ``crossovers`` holds, of the median realization; ``collapsed`` (case,) packings of each."""
    smallest, largest = (usual["limits"].values[..., end] for end in (0, 1))
    median = np.array([[one.median for one in row] for row in table])
    columns = {
        "force": np.clip(median, smallest, largest),
        "kind": np.where(median == -np.inf, BELOW, np.where(median == np.inf, ABOVE, FOUND)).astype(np.int8),
        "interval": np.array([[one.median_interval for one in row] for row in table]),
        "draws": np.array([[one.median_draws for one in row] for row in table], np.float32),
        "limits": usual["limits"].values,
    }
    data = usual[list(columns)].assign({name: usual[name].copy(data=values) for name, values in columns.items()})
    return data.assign(collapsed=variable("case", collapsed, "packings that collapse along their load paths"))


def _starts(source: xr.Dataset, parameters: Parameters, shapes: xr.Dataset, packings: xr.Dataset) -> xr.Dataset:
    """Every start of a polydispersity under one force: its dip, and what touches at rest."""
    chosen, steps = [], []
    for one in parameters.compared:
        alike = np.isclose(source["polydispersity"].values, one.polydispersity)
        under = np.isclose(source["force"].values, one.force)
        cases = np.flatnonzero(alike & under.any(axis=1))
        usual = packings["lattice_constant"].values[cases] == packings["lattice_constant"].values[0]
        distance = np.where(usual, 2.0 / (1.0 - 0.5 * one.polydispersity), np.nan)
        distance[~usual] = packings["lattice_constant"].values[cases[~usual]].astype(float)
        chosen += [(int(case), float(d), one.force) for case, d in zip(cases, distance, strict=True)]
        steps += [int(np.flatnonzero(under[case])[0]) for case in cases]
    order = [case for case, _, _ in chosen]
    along = {"case": xr.DataArray(order, dims="case"), "step": xr.DataArray(steps, dims="case")}
    at_force = shapes[["shape", "shape_interval"]].isel(along)
    drawn = parameters.draws, parameters.seed
    lattice = [float(packings[name].values[0, 0]) for name in ("horizontal_contacts", "oblique_contacts")]
    numbers: dict[str, list[FloatArray]] = {"contacts": [], "missing_horizontal": []}
    for case in order:
        count = int(packings["realizations"].values[case])
        packing = packings.isel(case=case, realization=slice(0, count))
        kinds = zip(("horizontal_contacts", "oblique_contacts"), lattice, strict=True)
        gone = [full - packing[kind].values for kind, full in kinds]
        for name, values in (
            ("contacts", packing["coordination_number_with_walls"].values),
            ("missing_horizontal", gone[0] / (gone[0] + gone[1])),
        ):
            means = weights(count, *drawn) @ values / count
            numbers[name].append(np.array([values.mean(), *np.quantile(means, LEVELS)]))
    text = {
        "contacts": "mean number of contacts of a disk at rest, walls counted",
        "missing_horizontal": "horizontal part of the contacts that the lattice has and the packing has not",
    }
    made = {}
    for name, rows in numbers.items():
        values = np.array(rows)
        made[name] = variable("case", values[:, 0], text[name])
        made[f"{name}_interval"] = variable(("case", "level"), values[:, 1:], "quantiles of the bootstrapped mean")
    return xr.Dataset(
        {
            "dip": at_force["shape"].variable,
            "dip_interval": at_force["shape_interval"].variable,
            "applied_force": variable("case", [force for _, _, force in chosen], f"applied force {FORCE}"),
            "distance": variable(
                "case", [d for _, d, _ in chosen], f"distance of neighbours before gravity acts {LENGTH}"
            ),
            **made,
        },
        coords={
            **{name: source[name].isel(case=order).variable for name in CASE},
            **{name: shapes[name].variable for name in ("width", "level")},
        },
    )


def _means_of_few(
    starts: xr.Dataset, source: xr.Dataset, parameters: Parameters, x: FloatArray
) -> dict[str, xr.Variable]:
    """Which part of the means of the largest of ``numbers`` realizations have two peaks, for every start."""
    number, parts = max(parameters.numbers), []
    for width in parameters.widths:
        for start in range(starts.sizes["case"]):
            same = [source[name].values == starts[name].values[start] for name in CASE]
            case = int(np.flatnonzero(np.logical_and.reduce(same))[0])
            ensemble = read_ensemble(source, case, x, width, parameters.least_part)
            step = int(np.argmin(np.abs(ensemble.force - float(starts["applied_force"][start]))))
            rows = folded(ensemble.response[:, step])
            rows = rows[np.isfinite(rows[:, 0])]
            parts.append(part_of_samples(rows, x, width, number, seed=parameters.seed, tolerance=parameters.tolerance))
    every = np.reshape(parts, (len(parameters.widths), starts.sizes["case"], -1))
    text = f"part of the means of {number} realizations, drawn at random, that have two peaks"
    quantile = "quantiles of that part over draws of the realizations"
    return {
        "two_peaked_means": variable(("width", "case"), every.mean(axis=-1), text),
        "two_peaked_means_interval": variable(
            ("width", "case", "level"), np.moveaxis(np.quantile(every, LEVELS, axis=-1), 0, -1), quantile
        ),
    }


def _linear_range(source: xr.Dataset, width: float, x: FloatArray) -> xr.Dataset:
    profiles = [smoothed(source.isel(case=case), x, width) for case in range(source.sizes["case"])]
    changes = []
    for profile in profiles:
        small = profile[:, :1]
        changes.append(np.linalg.norm(profile - small, axis=-1) / np.linalg.norm(small, axis=-1))
    each = ("case", "realization", "step")
    return xr.Dataset(
        {
            "response_at_centre": variable(
                each,
                np.array([profile[..., np.argmin(np.abs(x))] for profile in profiles]),
                "smoothed response at x = 0 in 1/mean radius: stress per applied force",
            ),
            "profile_change": variable(
                each,
                np.array(changes),
                "root mean square change of the smoothed response from that to the smallest force, relative to it",
            ),
            "applied_force": variable(("case", "step"), source["force"].values, f"applied force {FORCE}"),
        },
        coords={name: source[name].variable for name in CASE},
        attrs={"width": width},
    )


#: Coordinates of a case.
CASE = ("polydispersity", "friction", "wall_friction", "lattice_constant", "realizations")


def _datasets(
    source: xr.Dataset, parameters: Parameters, table: Sequence[Sequence[Crossing]], single: Sequence[Sequence[Singles]]
) -> dict[str, xr.Dataset]:
    most = {"step": source.sizes["step"], "realization": source.sizes["realization"]}

    def grid(name: str, rows: Sequence[Sequence[Crossing | Singles]] = table) -> FloatArray:
        return np.array([[getattr(one, name) for one in row] for row in rows])

    def along(name: str, dims: Sequence[str], rows: Sequence[Sequence[Crossing | Singles]] = table) -> FloatArray:
        """Filled up with nan to the most realizations and the longest load path."""
        first = np.asarray(getattr(rows[0][0], name))
        sizes = [most.get(dim, n) for dim, n in zip(dims, first.shape, strict=True)]
        filled = np.full((len(rows), len(rows[0]), *sizes), np.nan)
        for w, row in enumerate(rows):
            for c, one in enumerate(row):
                value = np.asarray(getattr(one, name))
                filled[w, c][tuple(slice(0, n) for n in value.shape)] = value
        return filled

    dims = ("width", "case")
    cases = {name: source[name].variable for name in CASE}
    coordinates = {
        "width": variable("width", parameters.widths, f"width w of the smoothing Gaussian {LENGTH}"),
        "level": variable("level", LEVELS, "part of the bootstrap draws below"),
        **cases,
    }
    kinds = flags(KINDS)
    what = "whether the crossover was found or is a bound"
    drawn = f"bootstrapped crossover forces {FORCE}, alike in cases of as many realizations; infinite beyond bounds"
    quantile = f"quantiles of the bootstrapped crossover force {FORCE}; infinite beyond bounds"
    crossovers = xr.Dataset(
        {
            "force": variable(dims, grid("force"), f"crossover force of the mean response, or its bound {FORCE}"),
            "kind": variable(dims, grid("kind").astype(np.int8), what, **kinds),
            "interval": variable((*dims, "level"), grid("interval"), quantile),
            "draw_part": variable((*dims, "kind_of_draw"), grid("kinds"), "part of the bootstrap draws of each kind"),
            "draws": variable((*dims, "draw"), grid("draws").astype(np.float32), drawn),
            "limits": variable((*dims, "end"), grid("limits"), f"smallest and largest force with a mean {FORCE}"),
        },
        coords={
            **coordinates,
            "kind_of_draw": variable("kind_of_draw", list(KINDS), "kinds of bootstrap draws"),
        },
        attrs={"tolerance": parameters.tolerance},
    )
    others = [[one.others for one in row] for row in table]
    dims_of_others = ("width", "case", "tolerance")
    definitions = xr.Dataset(
        {
            "force": variable(
                dims_of_others,
                [[[other[0] for other in one] for one in row] for row in others],
                f"crossover force of the mean response, or its bound {FORCE}",
            ),
            "kind": variable(
                dims_of_others,
                np.array([[[other[1] for other in one] for one in row] for row in others], np.int8),
                what,
                **kinds,
            ),
            "interval": variable(
                (*dims_of_others, "level"),
                [[[quantiles(other[2]) for other in one] for one in row] for row in others],
                quantile,
            ),
            "draws": variable(
                (*dims_of_others, "draw"),
                np.array([[[other[2] for other in one] for one in row] for row in others], np.float32),
                drawn,
            ),
            "limits": crossovers["limits"].variable,
        },
        coords={
            **coordinates,
            "tolerance": variable("tolerance", parameters.other_tolerances, "shape from which on there are two peaks"),
        },
    )
    step, each = (*dims, "step"), (*dims, "realization", "step")
    shapes = xr.Dataset(
        {
            "applied_force": variable(("case", "step"), source["force"].values, f"applied force {FORCE}"),
            "shape": variable(step, along("shapes", ["step"]), "shape of the mean response: positive with two peaks"),
            "shape_interval": variable(
                (*step, "level"), along("spread", ["step", "level"]), "quantiles of the bootstrapped shape"
            ),
            "two_peaked_means": variable(
                (*step, "number"),
                along("two_peaked", ["step", "number"]),
                "part of the means of so many realizations, drawn at random, that have two peaks",
            ),
            "spread": variable(
                step,
                along("spread", ["step"], single),
                "standard deviation of the response over realizations in 1/mean radius, mean over x",
            ),
            "spread_interval": variable(
                (*step, "level"),
                along("spread_interval", ["step", "level"], single),
                "quantiles of the bootstrapped standard deviation",
            ),
            "largest_step": variable(
                dims,
                grid("step", single),
                "largest change of shape or asymmetry of the mean between neighbouring forces",
            ),
            "largest_step_interval": variable(
                (*dims, "level"), grid("step_interval", single), "quantiles of the bootstrapped largest change"
            ),
        },
        coords={**coordinates, "number": variable("number", parameters.numbers, "realizations in a mean")},
        attrs={"tolerance": parameters.tolerance},
    )
    outcome = source["outcome"].values
    gone = (outcome == COLLAPSED).any(axis=-1)
    at = np.where(gone, (outcome == COLLAPSED).argmax(axis=-1), 0)
    force = np.broadcast_to(source["force"].values[:, None, :], outcome.shape)
    collapse = np.where(gone, np.take_along_axis(force, at[..., None], axis=-1)[..., 0], np.nan)
    realizations = xr.Dataset(
        {
            "shape": variable(
                each,
                along("shapes", ["realization", "step"], single),
                "shape of each response, by the lower of the largest values on both sides",
            ),
            "asymmetry": variable(
                each,
                along("leans", ["realization", "step"], single),
                "largest difference of a point and its mirror image, per largest response",
            ),
            "difference": variable(
                each,
                along("differences", ["realization", "step"], single),
                "root mean square difference from the mean response, per root mean square of the mean",
            ),
            "crossover": variable(
                (*dims, "realization"),
                along("force", ["realization"], single),
                f"crossover force, or its bound {FORCE}",
            ),
            "kind": variable(
                (*dims, "realization"),
                np.nan_to_num(along("kind", ["realization"], single), nan=-1).astype(np.int8),
                f"{what}; -1 where there is no realization",
                **kinds,
            ),
            "median": variable(
                dims,
                grid("median", single),
                f"median crossover force of the realizations {FORCE}, what lies beyond a path or a collapse censored",
            ),
            "median_interval": variable(
                (*dims, "level"), grid("median_interval", single), "quantiles of the bootstrapped median"
            ),
            "collapse_force": variable(
                ("case", "realization"), collapse, f"force under which the packing collapsed {FORCE}; nan for none"
            ),
        },
        coords=coordinates,
    )
    for name in ("shape", "asymmetry", "difference"):
        realizations[name] = realizations[name].astype(np.float32)
    return {"crossovers": crossovers, "definitions": definitions, "shapes": shapes, "realizations": realizations}
