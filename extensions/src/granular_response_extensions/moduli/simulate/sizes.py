"""How many layers a packing needs to respond as an elastic slab."""

from __future__ import annotations

import numpy as np

from granular_response.state import FloatArray
from granular_response_paper.survey.crossover import CONFIDENCE

#: How many times the largest size a power is believed at most.
FARTHEST = 100.0


def needed(layers: FloatArray, difference: FloatArray, tolerances: FloatArray, draws: int, seed: int) -> FloatArray:
    """(tolerance, 3) layers from which on the difference is below a tolerance, and the 95 % interval of that.

    A power of the number of ``layers`` (size,) goes through the means of ``difference`` (size, realization); the
    interval is that of ``draws`` bootstrap draws over the realizations of each size. Infinite beyond ``FARTHEST`` times
    the largest size, and where the power does not fall; all nan with less than two sizes of three realizations.
    """
    enough = np.isfinite(difference).sum(axis=1) >= 3
    if enough.sum() < 2:
        return np.full((len(tolerances), 3), np.nan)
    generator, layers = np.random.default_rng(seed), layers[enough]
    each = [one[np.isfinite(one)] for one in difference[enough]]
    drawn = [np.append(one.mean(), one[generator.integers(0, one.size, (draws, one.size))].mean(1)) for one in each]
    slope, offset = np.polyfit(np.log(layers), np.log(np.stack(drawn)), 1)
    # logarithm of the size, at most that of FARTHEST, beyond which it counts as infinite; flat is infinite too
    farthest = np.log(FARTHEST * layers.max())
    flat = slope > -1e-2
    place = np.where(flat, np.inf, (np.log(tolerances)[:, None] - offset) / np.where(flat, -1.0, slope))
    size = np.where(place > farthest, np.inf, np.exp(np.minimum(place, farthest)))
    low, high = np.quantile(size[:, 1:], CONFIDENCE, axis=1, method="nearest")
    return np.stack([size[:, 0], low, high], axis=1)
