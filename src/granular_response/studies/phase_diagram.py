"""The force at which one peak becomes two, against friction and disorder: Fig. 22 and claim D6.

The paper's figure is a sketch; here it is measured on the responses of ``polydisperse_averages``, so nothing is
simulated again.

Two peaks. The mean over an ensemble of mirror-symmetric slabs is symmetric but for noise, so the mean smoothed
response is made symmetric about x = 0 first. Its *shape* is

    (largest value at distances from ``width`` to ``reach`` - value at x = 0) / largest value up to ``reach`` ,

and the response has two peaks where the shape is positive. Peaks nearer than the smoothing width are not
told apart from one.

Crossover. The smallest force of a load path at which there are two peaks, moved back by linear interpolation of
the shape in the logarithm of the force to where it vanishes. Where there are two peaks at the smallest force
already, that force is an upper bound; where there are none up to the largest force at which enough realizations
are at rest, that force is a lower bound.

Interval. Realizations are drawn with replacement, each with its whole load path, and the crossover of each draw is
found; draws without one count as beyond the bound.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response import store
from granular_response.observe.floor import smoothed_response
from granular_response.result import FORCE, LENGTH, variable
from granular_response.studies.polydisperse_averages import AT_REST
from granular_response.sweep import Progress

FloatArray = NDArray[np.float64]

#: What a crossover is known to be.
FOUND, BELOW, ABOVE = 0, 1, 2
KINDS = ("found", "below_smallest_force", "above_largest_force")

#: Levels of the stored interval: one and two standard deviations of a normal distribution.
LEVELS = (0.025, 0.16, 0.5, 0.84, 0.975)


@dataclass(frozen=True)
class Ensemble:
    """Smoothed, symmetric responses of the realizations of one case."""

    force: FloatArray  #: (k,)
    response: FloatArray  #: (r, k, x), x from 0; nan where a realization is not at rest

    def mean(self, chosen: NDArray[np.intp], least: int) -> FloatArray:
        """(k, x) mean over ``chosen`` realizations; nan where fewer than ``least`` are at rest."""
        values = self.response[chosen]
        here = np.isfinite(values[:, :, :1])
        count = here.sum(axis=0)
        total = np.where(here, values, 0.0).sum(axis=0)
        return np.where(count >= least, total / np.maximum(count, 1), np.nan)


def shape(x: FloatArray, response: FloatArray, width: float) -> FloatArray:
    """How much higher symmetric responses (..., len(x)) are beside x = 0 than there; see the module's docstring.

    ``x`` runs from 0 to the reach.
    """
    largest = response.max(axis=-1)
    return (response[..., x >= width].max(axis=-1) - response[..., 0]) / largest


def crossover(force: FloatArray, shapes: FloatArray) -> tuple[float, int]:
    """Crossover force of a path, and whether it was FOUND or is a bound (BELOW, ABOVE).

    ``shapes`` (k,) may be nan from some force on; nan everywhere gives nan and ABOVE.
    """
    known = np.isfinite(shapes)
    if not known.any():
        return float("nan"), ABOVE
    double = np.flatnonzero(known & (shapes > 0.0))
    if not double.size:
        return float(force[known][-1]), ABOVE
    k = int(double[0])
    if k == 0:
        return float(force[0]), BELOW
    part = shapes[k - 1] / (shapes[k - 1] - shapes[k])
    return float(np.exp(np.log(force[k - 1]) + part * np.log(force[k] / force[k - 1]))), FOUND


def bootstrap(
    ensemble: Ensemble, x: FloatArray, width: float, *, draws: int, least: int, seed: int
) -> tuple[FloatArray, NDArray[np.int8]]:
    """(draws,) crossover forces of ensembles drawn with replacement, and their kinds."""
    rng = np.random.default_rng(seed)
    r = len(ensemble.response)
    forces, kinds = np.empty(draws), np.empty(draws, np.int8)
    for d in range(draws):
        mean = ensemble.mean(rng.integers(0, r, r), least)
        forces[d], kinds[d] = crossover(ensemble.force, shape(x, mean, width))
    return forces, kinds


def agreement(
    ensemble: Ensemble, x: FloatArray, width: float, few: int, *, draws: int, least: int, seed: int
) -> FloatArray:
    """(k,) part of the ``draws`` of ``few`` different realizations whose mean has as many peaks as that of all.

    nan where fewer than ``few`` realizations are at rest.
    """
    everybody = shape(x, ensemble.mean(np.arange(len(ensemble.response)), least), width) > 0.0
    rng = np.random.default_rng(seed)
    result = np.full(len(ensemble.force), np.nan)
    for k in range(len(ensemble.force)):
        rows = ensemble.response[np.isfinite(ensemble.response[:, k, 0]), k]
        if len(rows) >= max(few, least):
            picked = np.stack([rng.permutation(len(rows))[:few] for _ in range(draws)])
            result[k] = np.mean((shape(x, rows[picked].mean(axis=1), width) > 0.0) == everybody[k])
    return result


def simulate(
    parameters: Mapping[str, Any], *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``crossovers``, one entry for each case, and ``shapes``, the shape against the force.

    Parameters
    ----------
    parameters
        ``responses``, the file with the datasets of ``polydisperse_averages``; ``widths`` of the smoothing
        Gaussian; ``reach`` and ``spacing`` of the x axis; ``draws`` of the bootstrap and its ``seed``; ``few``, the
        size of the small averages of D5; ``least_part`` of the realizations that must be at rest.
    workers
        Not used: it takes seconds.

    Raises
    ------
    granular_response.store.StoreError
        If the responses cannot be read.
    ValueError
        If a parameter is out of range.
    """
    draws, few, seed = int(parameters["draws"]), int(parameters["few"]), int(parameters["seed"])
    part, spacing = float(parameters["least_part"]), float(parameters["spacing"])
    if draws < 1 or few < 1:
        raise ValueError(f"draws = {draws}, few = {few}: must be at least 1")
    if not 0.0 < part <= 1.0:
        raise ValueError(f"least_part = {part:g}: must be above 0, at most 1")
    x = spacing * np.arange(round(float(parameters["reach"]) / spacing) + 1)
    widths = [float(w) for w in parameters["widths"]]
    source = store.read(Path(parameters["responses"]))["ensembles"]
    cases, steps = source.sizes["case"], source.sizes["step"]

    grid = (len(widths), cases)
    force, central = np.full(grid, np.nan), np.full(grid, np.nan)
    kind, kinds = np.full(grid, ABOVE, np.int8), np.zeros((*grid, len(KINDS)))
    interval = np.full((*grid, len(LEVELS)), np.nan)
    shapes, spread = np.full((*grid, steps), np.nan), np.full((*grid, steps, len(LEVELS)), np.nan)
    alike = np.full((*grid, steps), np.nan)
    for w, width in enumerate(widths):
        for c in range(cases):
            ensemble = read_ensemble(source, c, x, width)
            k, r = len(ensemble.force), len(ensemble.response)
            least = max(1, int(np.ceil(part * r)))
            everybody = shape(x, ensemble.mean(np.arange(r), least), width)
            shapes[w, c, :k] = everybody
            force[w, c], kind[w, c] = crossover(ensemble.force, everybody)
            found, how = bootstrap(ensemble, x, width, draws=draws, least=least, seed=seed)
            kinds[w, c] = np.bincount(how, minlength=len(KINDS)) / draws
            # a bound sorts beyond every force: below all that are found, or above
            ranked = np.where(how == BELOW, -np.inf, np.where(how == ABOVE, np.inf, found))
            interval[w, c] = np.quantile(ranked, LEVELS, method="inverted_cdf")
            central[w, c] = interval[w, c, LEVELS.index(0.5)]
            drawn = _drawn_shapes(ensemble, x, width, draws=draws, least=least, seed=seed)
            known = np.isfinite(drawn).all(axis=0)
            spread[w, c, :k][known] = np.quantile(drawn[:, known], LEVELS, axis=0).T
            alike[w, c, :k] = agreement(ensemble, x, width, few, draws=draws, least=least, seed=seed)
        if progress is not None:
            progress(w + 1, len(widths), "crossovers")
    return _datasets(source, widths, few, force, kind, kinds, interval, shapes, spread, alike)


def read_ensemble(source: xr.Dataset, case: int, x: FloatArray, width: float) -> Ensemble:
    """The realizations of a case, smoothed and made symmetric about the loaded disk."""
    one = source.isel(case=case, realization=slice(0, int(source["realizations"][case])))
    used = np.isfinite(one["force"].values)
    force = one["force"].values[used]
    response = np.full((one.sizes["realization"], len(force), len(x)), np.nan)
    for r in range(len(response)):
        at = one["x"].values[r]
        here = np.isfinite(at)
        for k in np.flatnonzero(one["outcome"].values[r, used] == AT_REST):
            values = one["floor_response"].values[r, k, here]
            both = smoothed_response(np.concatenate([x, -x]), at[here], values, width)
            response[r, k] = 0.5 * (both[: len(x)] + both[len(x) :])
    return Ensemble(force, response)


def _drawn_shapes(ensemble: Ensemble, x, width: float, *, draws: int, least: int, seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    r = len(ensemble.response)
    return np.stack([shape(x, ensemble.mean(rng.integers(0, r, r), least), width) for _ in range(draws)])


def _datasets(source, widths, few, force, kind, kinds, interval, shapes, spread, alike) -> dict[str, xr.Dataset]:
    dims = ("width", "case")
    coordinates = {
        "width": variable(("width",), np.array(widths), f"width w of the smoothing Gaussian {LENGTH}"),
        "level": variable(("level",), np.array(LEVELS), "part of the bootstrap draws below"),
        **{
            name: source[name].variable
            for name in ("polydispersity", "friction", "lattice_constant", "realizations")
        },
    }
    flags = {"flag_values": np.arange(len(KINDS), dtype=np.int8), "flag_meanings": " ".join(KINDS)}
    crossovers = xr.Dataset(
        {
            "force": variable(dims, force, f"crossover force of the mean response, or its bound {FORCE}"),
            "kind": variable(dims, kind, "whether the crossover was found or is a bound", **flags),
            "interval": variable(
                (*dims, "level"), interval, f"quantiles of the bootstrapped crossover force {FORCE}; infinite beyond bounds"
            ),
            "draw_part": variable((*dims, "kind_of_draw"), kinds, "part of the bootstrap draws of each kind"),
        },
        coords={
            **coordinates,
            "kind_of_draw": variable(("kind_of_draw",), list(KINDS), "kinds of bootstrap draws"),
        },
    )
    along = (*dims, "step")
    table = xr.Dataset(
        {
            "applied_force": variable(("case", "step"), source["force"].values, f"applied force {FORCE}"),
            "shape": variable(along, shapes, "shape of the mean response: positive with two peaks"),
            "shape_interval": variable((*along, "level"), spread, "quantiles of the bootstrapped shape"),
            "few_agree": variable(
                along, alike, f"part of the averages of {few} realizations with as many peaks as the mean of all"
            ),
        },
        coords=coordinates,
        attrs={"few": few},
    )
    return {"crossovers": crossovers, "shapes": table}
