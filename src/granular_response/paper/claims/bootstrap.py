"""Confidence of a statistic of a few realizations: 95 % of the bootstrap draws over them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .claim import NotMeasured, Quantity

FloatArray = NDArray[np.float64]
Statistic = Callable[..., FloatArray]

#: Draws, and the part of them that an interval leaves out on both sides together.
DRAWS, OUTSIDE = 2000, 0.05


def over_realizations(values: ArrayLike, statistic: Statistic = np.median) -> Quantity:
    """``statistic`` (np.median, np.mean, ...: called with ``axis``) of finite ``values`` (r,) with its interval.

    Raises NotMeasured with fewer than three values: nothing can be said about their spread.
    """
    found = np.asarray(values, dtype=float)
    found = found[np.isfinite(found)]
    if found.size < 3:
        raise NotMeasured(f"{found.size} realizations: an interval needs three or more")
    picked = np.random.default_rng(0).integers(0, found.size, (DRAWS, found.size))
    low, high = np.quantile(statistic(found[picked], axis=1), [0.5 * OUTSIDE, 1.0 - 0.5 * OUTSIDE])
    return Quantity(float(statistic(found, axis=0)), float(low), float(high), "confidence")
