"""Confidence of a statistic of a few realizations: 95 % of the bootstrap draws, or the exact interval of a part."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import betaincinv

from .numbers import Quantity, needs

#: Number of draws, and the ends of an interval that holds 95 % of them: a part of samples below the first is rare.
DRAWS, LEVELS = 2000, (0.025, 0.975)
RARE = LEVELS[0]


def of_draws(value: float | None, draws: ArrayLike, test: str, samples: int, method: Any = "linear") -> Quantity:
    """A number with 95 % of its draws (d,), or of the ends (2, d) between which each lies, by numpy's ``method``."""
    ends = np.broadcast_to(draws, (2, np.shape(draws)[-1]))
    low, high = (float(np.quantile(one, level, method=method)) for one, level in zip(ends, LEVELS, strict=True))
    return Quantity(None if value is None else float(value), low, high, "confidence", test, samples)


def _picked(number: int) -> NDArray[np.intp]:
    """(d, number) which realizations each draw has. NotMeasured for less than three, which do not show a spread."""
    needs(number >= 3, f"{number} realizations: an interval needs three or more")
    return np.random.default_rng(0).integers(0, number, (DRAWS, number))


def over_realizations(values: ArrayLike, statistic: Callable[..., Any] = np.median) -> Quantity:
    """``statistic`` (np.median, np.mean, ...: called with ``axis``) of finite ``values`` (r,) with its interval.

    Raises NotMeasured with fewer than three values.
    """
    found = np.asarray(values, dtype=float)
    found = found[np.isfinite(found)]
    drawn = statistic(found[_picked(found.size)], axis=1)
    return of_draws(float(statistic(found, axis=0)), drawn, f"bootstrap of the {statistic.__name__}", found.size)


def part_of(hits: ArrayLike, unknown: ArrayLike = False) -> Quantity:
    """The part of realizations that are hits (r,), with its exact binomial interval (Clopper and Pearson): it is open
    where all or none are.

    Of those that are ``unknown`` (r,) none count as hits for the lower end, and all for the upper one; the value leaves
    them out. Raises NotMeasured without realizations.
    """
    found = np.asarray(hits, dtype=bool)
    censored = np.broadcast_to(unknown, found.shape)
    number, hit, known = found.size, int((found & ~censored).sum()), int((~censored).sum())
    needs(number, "no realizations")
    most = hit + number - known
    low = float(betaincinv(hit, number - hit + 1, LEVELS[0])) if hit else 0.0
    high = float(betaincinv(most + 1, number - most, LEVELS[1])) if most < number else 1.0
    return Quantity(hit / known if known else None, low, high, "confidence", "exact binomial interval", number)


def over_brackets(each: Sequence[Quantity], median: Callable[..., Any] = np.median) -> Quantity:
    """Median of realizations, each known within an interval of its own, with the interval that its draws leave.

    It holds what realizations differ by and what is not known of each, some of which have no upper end. One realization
    is what it is; raises NotMeasured for two or none.
    """
    if len(each) == 1:
        return each[0]
    picked = _picked(len(each))
    low, high = (np.array([getattr(one, end) for one in each]) for end in ("low", "high"))
    middle = median([one.value if one.value is not None else 0.5 * (one.low + one.high) for one in each], axis=0)
    drawn = [median(end[picked], axis=1) for end in (low, high)]
    middle = float(middle) if np.isfinite(middle) else None
    return of_draws(middle, drawn, "bootstrap of the median", len(each), "inverted_cdf")
