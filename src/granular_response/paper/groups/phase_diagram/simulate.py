"""The force at which one peak becomes two, against friction and disorder: Fig. 22, claims D3 and D6.

The paper's figure is a sketch; here it is measured on the load paths of ``polydisperse_averages``, the lattice among
them, so nothing is simulated again.

Two peaks. The mean over an ensemble of mirror-symmetric slabs is symmetric but for noise, so the mean smoothed
response is made symmetric about x = 0 first. Its *shape* is

    (largest value at distances from ``width`` to ``reach`` - value at x = 0) / largest value up to ``reach`` ,

and the response has two peaks where the shape is positive. Peaks nearer than the smoothing width are not
told apart from one.

Crossover. Between two phases there is one boundary, so the shape is taken to grow with the force: its
least-squares non-decreasing fit along the load path keeps a chance dip of a finite ensemble from counting as a
boundary of its own. The crossover is where this fit, linear in the logarithm of the force, vanishes. Where it is
positive at the smallest force already, that force is an upper bound; where it is nowhere positive up to the largest
force at which enough realizations are at rest, that force is a lower bound.

Interval. Realizations are drawn with replacement, each with its whole load path, and the crossover of each draw is
found; draws without one count as beyond the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from granular_response.paper.ensembles import smoothed
from granular_response.paper.groups.phase_diagram.parameters import Parameters
from granular_response.store import files as store
from granular_response.store.result import FORCE, LENGTH, variable
from granular_response.sweeps.tasks import Progress

FloatArray = NDArray[np.float64]

#: What a crossover is known to be.
FOUND, BELOW, ABOVE = 0, 1, 2
KINDS = ("found", "below_smallest_force", "above_largest_force")

#: Levels of the stored interval: one and two standard deviations of a normal distribution.
LEVELS = (0.025, 0.16, 0.5, 0.84, 0.975)


@dataclass(frozen=True)
class Ensemble:
    """Smoothed, symmetric responses of the realizations of one case.

    ``force`` (k,); ``response`` (r, k, x), with x from 0, nan where a realization is not at rest; ``least``, the
    number of realizations that a mean needs.
    """

    force: FloatArray
    response: FloatArray
    least: int = 1

    def means(self, weights: FloatArray) -> FloatArray:
        """(d, k, x) weighted means for ``weights`` (d, r); nan where less than ``least`` of the weight is at rest."""
        here = np.isfinite(self.response[:, :, 0])
        r, k, points = self.response.shape
        values = np.where(here[:, :, None], self.response, 0.0).reshape(r, k * points)
        total = (weights @ values).reshape(-1, k, points)
        count = (weights @ here)[:, :, None]
        return np.where(count >= self.least, total / np.maximum(count, 1.0), np.nan)

    def mean(self) -> FloatArray:
        """(k, x) mean over all realizations."""
        return self.means(np.ones((1, len(self.response))))[0]


def shape(x: FloatArray, response: FloatArray, width: float) -> FloatArray:
    """How much higher symmetric responses (..., len(x)) are beside x = 0 than there; see the module's docstring.

    ``x`` runs from 0 to the reach.
    """
    largest = response.max(axis=-1)
    return np.asarray((response[..., x >= width].max(axis=-1) - response[..., 0]) / largest)


def crossover(force: FloatArray, shapes: FloatArray) -> tuple[float, int]:
    """Crossover force of a path, and whether it was FOUND or is a bound (BELOW, ABOVE).

    ``shapes`` (k,) may be nan from some force on; nan everywhere gives nan and ABOVE.
    """
    known = np.isfinite(shapes)
    if not known.any():
        return float("nan"), ABOVE
    force = force[known]
    fit = isotonic_regression(shapes[known]).x
    double = np.flatnonzero(fit > 0.0)
    if not double.size:
        return float(force[-1]), ABOVE
    k = int(double[0])
    if k == 0:
        return float(force[0]), BELOW
    part = fit[k - 1] / (fit[k - 1] - fit[k])
    return float(np.exp(np.log(force[k - 1]) + part * np.log(force[k] / force[k - 1]))), FOUND


def bootstrap(ensemble: Ensemble, x: FloatArray, width: float, *, draws: int, seed: int) -> FloatArray:
    """(draws, k) shapes of the means of ensembles drawn with replacement."""
    r = len(ensemble.response)
    picked = np.random.default_rng(seed).integers(0, r, (draws, r))
    weights = np.stack([np.bincount(row, minlength=r) for row in picked]).astype(float)
    return shape(x, ensemble.means(weights), width)


def agreement(ensemble: Ensemble, x: FloatArray, width: float, few: int, *, draws: int, seed: int) -> FloatArray:
    """(k,) part of the ``draws`` of ``few`` different realizations whose mean has as many peaks as that of all.

    nan where fewer than ``few`` realizations are at rest.
    """
    everybody = shape(x, ensemble.mean(), width) > 0.0
    rng = np.random.default_rng(seed)
    result = np.full(len(ensemble.force), np.nan)
    for k in range(len(ensemble.force)):
        rows = ensemble.response[np.isfinite(ensemble.response[:, k, 0]), k]
        if len(rows) >= max(few, ensemble.least):
            picked = rng.permuted(np.tile(np.arange(len(rows)), (draws, 1)), axis=1)[:, :few]
            result[k] = np.mean((shape(x, rows[picked].mean(axis=1), width) > 0.0) == everybody[k])
    return result


@dataclass(frozen=True)
class Crossing:
    """The crossover of one case with its statistics; arrays along the k forces of the case."""

    force: float
    kind: int
    kinds: FloatArray  #: (kinds,) part of the draws
    interval: FloatArray  #: (levels,)
    shapes: FloatArray  #: (k,)
    spread: FloatArray  #: (k, levels)
    alike: FloatArray  #: (k,)


def cross(ensemble: Ensemble, x: FloatArray, width: float, *, few: int, draws: int, seed: int) -> Crossing:
    """The crossover of an ensemble."""
    shapes = shape(x, ensemble.mean(), width)
    force, kind = crossover(ensemble.force, shapes)
    drawn = bootstrap(ensemble, x, width, draws=draws, seed=seed)
    found = [crossover(ensemble.force, row) for row in drawn]
    kinds = np.array([kind for _, kind in found])
    # a bound sorts beyond every force: below all that are found, or above
    ranked = np.where(
        kinds == BELOW, -np.inf, np.where(kinds == ABOVE, np.inf, np.array([value for value, _ in found]))
    )
    spread = np.full((len(shapes), len(LEVELS)), np.nan)
    known = np.isfinite(drawn).all(axis=0)
    spread[known] = np.quantile(drawn[:, known], LEVELS, axis=0).T
    return Crossing(
        force,
        kind,
        np.bincount(kinds, minlength=len(KINDS)) / draws,
        np.quantile(ranked, LEVELS, method="inverted_cdf"),
        shapes,
        spread,
        agreement(ensemble, x, width, few, draws=draws, seed=seed),
    )


def simulate(
    parameters: Parameters, *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``crossovers``, one entry for each case, and ``shapes``, the shape against the force.

    Raises
    ------
    granular_response.store.StoreError
        If the responses cannot be read.
    ValueError
        If a parameter is out of range.
    """
    draws, few, seed = parameters.draws, parameters.few, parameters.seed
    spacing, widths = parameters.spacing, parameters.widths
    x = np.arange(round(parameters.reach / spacing) + 1, dtype=float) * spacing
    source = store.read(Path(parameters.responses))["ensembles"]
    cases = source.sizes["case"]
    table: list[list[Crossing]] = []
    for done, width in enumerate(widths, 1):
        ensembles = (read_ensemble(source, case, x, width, parameters.least_part) for case in range(cases))
        table.append([cross(one, x, width, few=few, draws=draws, seed=seed) for one in ensembles])
        if progress is not None:
            progress(done, len(widths), "crossovers")
    return _datasets(source, widths, few, table)


def read_ensemble(source: xr.Dataset, case: int, x: FloatArray, width: float, least_part: float) -> Ensemble:
    """The realizations of a case, smoothed and made symmetric about the loaded disk."""
    one = source.isel(case=case, realization=slice(0, int(source["realizations"][case])))
    used = np.isfinite(one["force"].values)
    force = one["force"].values[used]
    both = smoothed(one.isel(step=used), np.concatenate([x, -x]), width)
    response = 0.5 * (both[..., : len(x)] + both[..., len(x) :])
    return Ensemble(force, response, max(1, int(np.ceil(least_part * len(response)))))


def _datasets(
    source: xr.Dataset, widths: Sequence[float], few: int, table: Sequence[Sequence[Crossing]]
) -> dict[str, xr.Dataset]:
    steps = source.sizes["step"]

    def grid(name: str) -> FloatArray:
        return np.array([[getattr(one, name) for one in row] for row in table])

    def along_force(name: str) -> FloatArray:
        """Filled up with nan to the longest load path."""
        values = [[getattr(one, name) for one in row] for row in table]
        filled = np.full((len(table), len(table[0]), steps, *values[0][0].shape[1:]), np.nan)
        for w, row in enumerate(values):
            for c, value in enumerate(row):
                filled[w, c, : len(value)] = value
        return filled

    dims = ("width", "case")
    coordinates = {
        "width": variable(("width",), np.array(widths), f"width w of the smoothing Gaussian {LENGTH}"),
        "level": variable(("level",), np.array(LEVELS), "part of the bootstrap draws below"),
        **{name: source[name].variable for name in ("polydispersity", "friction", "lattice_constant", "realizations")},
    }
    flags = {"flag_values": np.arange(len(KINDS), dtype=np.int8), "flag_meanings": " ".join(KINDS)}
    crossovers = xr.Dataset(
        {
            "force": variable(dims, grid("force"), f"crossover force of the mean response, or its bound {FORCE}"),
            "kind": variable(
                dims, grid("kind").astype(np.int8), "whether the crossover was found or is a bound", **flags
            ),
            "interval": variable(
                (*dims, "level"),
                grid("interval"),
                f"quantiles of the bootstrapped crossover force {FORCE}; infinite beyond bounds",
            ),
            "draw_part": variable((*dims, "kind_of_draw"), grid("kinds"), "part of the bootstrap draws of each kind"),
        },
        coords={
            **coordinates,
            "kind_of_draw": variable(("kind_of_draw",), list(KINDS), "kinds of bootstrap draws"),
        },
    )
    along = (*dims, "step")
    shapes = xr.Dataset(
        {
            "applied_force": variable(("case", "step"), source["force"].values, f"applied force {FORCE}"),
            "shape": variable(along, along_force("shapes"), "shape of the mean response: positive with two peaks"),
            "shape_interval": variable((*along, "level"), along_force("spread"), "quantiles of the bootstrapped shape"),
            "few_agree": variable(
                along,
                along_force("alike"),
                f"part of the averages of {few} realizations with as many peaks as the mean of all",
            ),
        },
        coords=coordinates,
        attrs={"few": few},
    )
    return {"crossovers": crossovers, "shapes": shapes}
