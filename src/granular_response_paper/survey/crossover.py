"""One peak or two: the shape of responses of an ensemble, and the force at which it changes (Sec. VI.A, Fig. 22).

Two peaks. The mean over an ensemble of mirror-symmetric slabs is symmetric but for noise, so the mean smoothed
response is made symmetric about x = 0 first (a single one is not: see ``shape_of_single``). Its *shape* is

    (largest value at distances from ``width`` to ``reach`` - value at x = 0) / largest value up to ``reach`` ,

and the response has two peaks where the shape exceeds ``tolerance``: a dip that a printed curve shows. Peaks nearer
than the smoothing width are not told apart from one. Figs. 19, 21 and 22 and all claims on disorder use this one
definition; what other tolerances give is stored beside it. A single realization is not symmetric, and made so, one peak
beside the middle would be two: its dip is that below the lower of the largest values on either side.

Crossover. Between two phases there is one boundary, so the shape is taken to grow with the force: its
least-squares non-decreasing fit along the load path keeps a chance dip of a finite ensemble from counting as a
boundary of its own. The crossover is where this fit, linear in the logarithm of the force, passes the tolerance. Where
it does so at the smallest force already, that force is an upper bound; where it does not up to the largest
force at which enough realizations are at rest, that force is a lower bound.

Interval. Realizations are drawn with replacement, each with its whole load path, and the crossover of each draw is
found; draws without one count as beyond the bound. Cases with as many realizations are drawn alike: they share their
radii, so the ratio of two crossovers has less scatter than either.

Single realizations. Each has a crossover of its own. Where its packing collapses or its path ends before, all that
is known is that the crossover lies higher: such values are censored, and the median over realizations is that of Kaplan
and Meier, which counts them as long as they last. Where packings collapse, this median is the crossover of the ensemble
for the claims: those near their collapse have responses many times as large as the others, and those beyond it none, so
the mean hangs on a few and leaves out the weakest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS, flags
from granular_response_paper.ensembles import at_rest
from granular_response_paper.records import column, record

#: What a crossover is known to be.
FOUND, BELOW, ABOVE = 0, 1, 2
KINDS = ("found", "below_smallest_force", "above_largest_force")

#: Ends of an interval of 95 %, and levels of the stored one: one and two standard deviations of a normal distribution.
CONFIDENCE = (0.025, 0.975)
LEVELS = (CONFIDENCE[0], 0.16, 0.5, 0.84, CONFIDENCE[1])


@dataclass(frozen=True)
class Ensemble:
    """Smoothed responses of the realizations of one case, and how they are judged.

    ``force`` (k,); ``response`` (r, k, x), nan where a realization is not at rest, on ``x`` from 0 to the reach, and to
    its left too unless they were made symmetric; ``width`` of smoothing; ``least``, how many realizations a mean needs.
    """

    force: FloatArray
    response: FloatArray
    x: FloatArray
    width: float
    least: int = 1
    tolerance: float = 0.0

    def means(self, weights: FloatArray) -> FloatArray:
        """(d, k, x) weighted means for ``weights`` (d, r); nan where less than ``least`` of the weight is at rest."""
        here, values = self._known
        count = weights @ here
        count[count < max(self.least, 1)] = np.nan
        total = (weights @ values).reshape(len(weights), *self.response.shape[1:])
        total /= count[:, :, None]
        return np.asarray(total)

    @cached_property
    def _known(self) -> tuple[FloatArray, FloatArray]:
        """(r, k) 1 where a realization is at rest, and (r, k x) its response, else 0."""
        here = np.isfinite(self.response[:, :, 0])
        return here.astype(float), np.where(here[:, :, None], self.response, 0.0).reshape(len(here), -1)

    def mean(self) -> FloatArray:
        """(k, x) mean over all realizations."""
        return self.means(np.ones((1, len(self.response))))[0]

    def shape(self, response: FloatArray) -> FloatArray:
        """The :func:`shape` of symmetric responses (..., x)."""
        return shape(self.x, response, self.width)


def folded(response: FloatArray) -> FloatArray:
    """Responses (..., 2 m + 1) on a grid that is symmetric about x = 0, made symmetric: (..., m + 1), from x = 0 on."""
    m = response.shape[-1] // 2
    return 0.5 * (response[..., m:] + response[..., m::-1])


def shape(x: FloatArray, response: FloatArray, width: float) -> FloatArray:
    """How much higher symmetric responses (..., len(x)) are beside x = 0 than there; see the module's docstring.

    ``x`` runs from 0 to the reach.
    """
    largest = response.max(axis=-1)
    return np.asarray((response[..., x >= width].max(axis=-1) - response[..., 0]) / largest)


def shape_of_single(x: FloatArray, response: FloatArray, width: float) -> FloatArray:
    """The shape of responses (..., 2 m + 1) that are not symmetric: by the lower of the largest values on both sides.

    ``x`` runs from 0 to the reach, as for :func:`shape`.
    """
    m = response.shape[-1] // 2
    sides = [side[..., x >= width].max(axis=-1) for side in (response[..., m:], response[..., m::-1])]
    return np.asarray((np.minimum(*sides) - response[..., m]) / response.max(axis=-1))


def lean(response: FloatArray) -> FloatArray:
    """Largest difference of a point and its mirror image in responses (..., 2 m + 1), per largest response."""
    return np.asarray(np.abs(response - response[..., ::-1]).max(axis=-1) / response.max(axis=-1))


def grown(shapes: FloatArray) -> FloatArray:
    """Least-squares non-decreasing fits of shapes (..., k) along the last axis; nan where they are.

    The fit at a point is the largest, over all beginnings up to it, of the smallest mean from there to any end from it
    on (T. Robertson et al., Order Restricted Statistical Inference, 1988, Sec. 1.4). ``scipy.optimize`` fits one path a
    call; bootstraps have four million.
    """
    known = np.isfinite(shapes)
    total, count = (
        np.cumsum(np.pad(one, [(0, 0)] * (one.ndim - 1) + [(1, 0)]), axis=-1)
        for one in (np.where(known, shapes, 0.0), known.astype(float))
    )
    fits = np.full(shapes.shape, -np.inf)
    for begin in range(shapes.shape[-1]):
        number = count[..., begin + 1 :] - count[..., begin, None]
        sums = total[..., begin + 1 :] - total[..., begin, None]
        means = np.divide(sums, number, out=np.full(number.shape, np.inf), where=number > 0)
        to_any_end = np.minimum.accumulate(means[..., ::-1], axis=-1)[..., ::-1]
        np.maximum(fits[..., begin:], to_any_end, out=fits[..., begin:])
    return np.where(known, fits, np.nan)


def passed(force: FloatArray, fits: FloatArray, tolerance: float = 0.0) -> tuple[FloatArray, NDArray[np.int8]]:
    """Where fits (..., k) along ``force`` (k,) pass a tolerance, and whether that was FOUND or is a bound: two (...).

    Fits that are nan everywhere give nan and ABOVE.
    """
    above = fits > tolerance
    at = np.where(np.isfinite(fits), np.arange(len(force)), -1)
    last = at.max(axis=-1)
    found = above.any(axis=-1)
    k = np.where(found, np.argmax(above, axis=-1), last)
    below = np.where(at < k[..., None], at, -1).max(axis=-1)  # the one before it that is known
    kind = np.where(found, np.where(below < 0, BELOW, FOUND), ABOVE).astype(np.int8)

    def of(index: NDArray[np.intp]) -> FloatArray:
        return np.take_along_axis(fits, index[..., None], axis=-1)[..., 0] - tolerance

    between = kind == FOUND
    low = np.where(between, below, 0)
    part = np.divide(of(low), of(low) - of(k), out=np.zeros(k.shape), where=between)
    inside = np.exp(np.log(force[low]) + part * np.log(force[k] / force[low]))
    return np.where(between, inside, np.where(last < 0, np.nan, force[k])), kind


def weights(realizations: int, draws: int, seed: int) -> FloatArray:
    """(draws, realizations) how often each is drawn, with replacement; alike for cases of as many realizations."""
    return counted(np.random.default_rng(seed).integers(0, realizations, (draws, realizations)), realizations)


def counted(picked: NDArray[np.int64], realizations: int) -> FloatArray:
    """(draws, realizations) how often each stands in a row of those ``picked`` (draws, k)."""
    places = picked + realizations * np.arange(len(picked))[:, None]
    return np.bincount(places.ravel(), minlength=len(picked) * realizations).reshape(-1, realizations).astype(float)


def _samples(realizations: int, number: int, seed: int, draws: int, samples: int) -> Iterator[NDArray[np.int64]]:
    """For each draw of the realizations with replacement: (samples, number) which of them are in means of so many."""
    rng = np.random.default_rng(seed)
    for _ in range(draws):
        drawn = rng.integers(0, realizations, realizations)
        yield drawn[rng.integers(0, realizations, (samples, number))]


def shapes_of_samples(ensemble: Ensemble, step: int, number: int, *, seed: int) -> FloatArray:
    """(200, 400) shapes of means of ``number`` of symmetric responses at a step, each row from a draw of these."""
    responses = at_rest(ensemble.response, step)
    picked = _samples(len(responses), number, seed, draws=200, samples=400)
    return np.stack([ensemble.shape(responses[one].mean(axis=1)) for one in picked])


def seen_in_samples(ensemble: Ensemble, number: int, *, seed: int, draws: int = 100, samples: int = 400) -> FloatArray:
    """(draws,) parts of samples of ``number`` realizations whose mean has a crossover, each from a draw of them.

    As :func:`shapes_of_samples` draws them, but each with its whole load path. A mean needs as large a part of its
    realizations at rest as that of the ensemble.
    """
    count = len(ensemble.response)
    few = replace(ensemble, least=int(np.ceil(number * ensemble.least / count)))

    def part(picked: NDArray[np.int64]) -> float:
        shapes = few.shape(few.means(counted(picked, count)))
        return float(np.mean(passed(few.force, grown(shapes), few.tolerance)[1] == FOUND))

    return np.array([part(picked) for picked in _samples(count, number, seed, draws, samples)])


def censored_medians(values: FloatArray, censored: NDArray[np.bool_], weights: FloatArray) -> FloatArray:
    """(d,) medians of Kaplan and Meier: values (r,) of which ``censored`` ones are only known to lie higher.

    ``weights`` (d, r) is how often each counts. A value -inf lies below all others. inf where fewer than half are known
    to be reached.
    """
    order = np.lexsort((censored, values))
    values, censored, count = values[order], censored[order], weights[:, order]
    left = count[:, ::-1].cumsum(axis=1)[:, ::-1]
    ends = np.divide(count, left, out=np.zeros(count.shape), where=(left > 0.0) & ~censored)
    reached = (np.cumprod(1.0 - ends, axis=1) <= 0.5 + 1e-12) & (count > 0.0)
    return np.where(reached.any(axis=1), values[np.argmax(reached, axis=1)], np.inf)


_DRAWN = f"bootstrapped crossover forces {WEIGHTS}, alike in cases of as many realizations; infinite beyond bounds"


@record
class Crossover:
    """Where the mean of one case has two peaks from on, by one tolerance."""

    force: float = column(f"crossover force of the mean response, or its bound {WEIGHTS}")
    kind: np.int8 = column("whether the crossover was found or is a bound", attributes=flags(KINDS))
    interval: FloatArray = column(
        f"quantiles of the bootstrapped crossover force {WEIGHTS}; infinite beyond bounds", "level"
    )
    draws: FloatArray = column(_DRAWN, "draw")  #: in their order


@record
class Crossing(Crossover):
    """The crossover of one case with its statistics; arrays along the k forces of the case."""

    limits: tuple[float, float] = column(f"smallest and largest force with a mean {WEIGHTS}", "end")
    shape: FloatArray = column("shape of the mean response: positive with two peaks", "step")
    shape_interval: FloatArray = column("quantiles of the bootstrapped shape", "step", "level")
    seen: float = column("part of the samples of some realizations, drawn at random, whose mean has a crossover")
    seen_interval: FloatArray = column("quantiles of that part over draws of the realizations", "level")
    others: tuple[Crossover, ...]  #: by other tolerances


def quantiles(draws: FloatArray) -> FloatArray:
    """(levels, ...) quantiles of draws (d, ...), of which some may be infinite."""
    return np.asarray(np.quantile(draws, LEVELS, axis=0, method="inverted_cdf"))


def cross(ensemble: Ensemble, *, number: int, draws: int, seed: int, others: Sequence[float] = ()) -> Crossing:
    """The crossover of an ensemble of symmetric responses, by its tolerance, by others, and in samples of a number."""
    shapes = ensemble.shape(ensemble.mean())
    drawn = ensemble.shape(ensemble.means(weights(len(ensemble.response), draws, seed)))
    fits = grown(drawn)

    def at(limit: float) -> Crossover:
        each, kinds = passed(ensemble.force, fits, limit)
        found = np.where(kinds == FOUND, each, np.where(kinds == BELOW, -np.inf, np.inf))  # bounds beyond every force
        force, kind = passed(ensemble.force, grown(shapes), limit)
        return Crossover(float(force), np.int8(kind), quantiles(found), found)

    used = ensemble.force[np.isfinite(shapes)]
    seen = seen_in_samples(ensemble, number, seed=seed)
    return Crossing(
        **vars(at(ensemble.tolerance)),
        limits=(float(used[0]), float(used[-1])) if used.size else (float("nan"), float("nan")),
        shape=shapes,
        shape_interval=np.quantile(drawn, LEVELS, axis=0).T,  # nan where a draw has none
        seen=float(seen.mean()),
        seen_interval=np.quantile(seen, LEVELS),
        others=tuple(at(limit) for limit in others),
    )


@record
class Singles:
    """Single realizations of one case beside their mean; arrays along r realizations and k forces."""

    spread: FloatArray = column(
        "standard deviation of the response over realizations in 1/mean radius, mean over x", "step"
    )
    spread_interval: FloatArray = column("quantiles of the bootstrapped standard deviation", "step", "level")
    largest_step: float = column("largest change of shape or asymmetry of the mean between neighbouring forces")
    largest_step_interval: FloatArray = column("quantiles of the bootstrapped largest change", "level")
    shape: FloatArray = column(
        "shape of each response, by the lower of the largest values on both sides", "realization", "step"
    )
    asymmetry: FloatArray = column(
        "largest difference of a point and its mirror image, per largest response", "realization", "step"
    )
    difference: FloatArray = column(
        "root mean square difference from the mean response, per root mean square of the mean", "realization", "step"
    )
    median: float = column(
        f"median crossover force of the realizations {WEIGHTS}, what lies beyond a path or a collapse censored"
    )
    median_draws: FloatArray  #: (draws,) infinite beyond bounds

    def middle(self, smallest: float, largest: float) -> Crossover:
        """The crossover of the median realization on a path between these forces."""
        kind = {-np.inf: BELOW, np.inf: ABOVE}.get(self.median, FOUND)
        force = float(np.clip(self.median, smallest, largest))
        return Crossover(force, np.int8(kind), quantiles(self.median_draws), self.median_draws)


def singles(ensemble: Ensemble, *, draws: int, seed: int) -> Singles:
    """What the realizations of an ensemble do that were not made symmetric."""
    shapes = shape_of_single(ensemble.x, ensemble.response, ensemble.width)
    drawn = weights(len(shapes), draws, seed)
    mean, means = ensemble.mean(), ensemble.means(drawn)
    off = np.sqrt(((ensemble.response - mean) ** 2).mean(axis=-1) / (mean**2).mean(axis=-1))
    square = replace(ensemble, response=ensemble.response**2)

    def deviation(squares: FloatArray, mean: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(np.maximum(squares - mean**2, 0.0)).mean(axis=-1))

    force, kind = passed(ensemble.force, grown(shapes), ensemble.tolerance)
    value = np.where(kind == BELOW, -np.inf, np.nan_to_num(force, nan=ensemble.force[0]))
    censored = kind == ABOVE
    medians = censored_medians(value, censored, drawn)
    return Singles(
        spread=deviation(square.mean(), mean),
        spread_interval=quantiles(deviation(square.means(drawn), means)).T,
        largest_step=float(largest_step(ensemble.shape(folded(mean)), lean(mean))),
        largest_step_interval=quantiles(largest_step(ensemble.shape(folded(means)), lean(means))),
        shape=shapes,
        asymmetry=lean(ensemble.response),
        difference=off,
        median=float(censored_medians(value, censored, np.ones((1, len(value))))[0]),
        median_draws=medians,
    )


def largest_step(shapes: FloatArray, leans: FloatArray) -> FloatArray:
    """Largest change between neighbouring forces (..., k) of either; nan without two known neighbours."""
    steps = np.fmax(np.abs(np.diff(shapes, axis=-1)), np.abs(np.diff(leans, axis=-1)))
    return np.asarray(np.fmax.reduce(steps, axis=-1, initial=np.nan))
