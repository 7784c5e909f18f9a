"""How wide a profile is."""

from __future__ import annotations

import numpy as np

from ..state import FloatArray


def last_passage(t: FloatArray, profile: FloatArray, level: float) -> float:
    """Where the profile passes the level for the last time, linear between samples; NaN if it ends above."""
    k = int(np.flatnonzero(profile >= level)[-1])
    if k == len(t) - 1:
        return np.nan
    return float(t[k] + (profile[k] - level) / (profile[k] - profile[k + 1]) * (t[k + 1] - t[k]))


def half_maximum_width(x: FloatArray, response: FloatArray) -> float:
    """Distance of the outermost places where the response passes half of its maximum.

    Linear between samples; nan where a side does not fall to half. Peaks that reach half count as one.
    """
    half = 0.5 * float(response.max())
    return last_passage(x, response, half) + last_passage(-x[::-1], response[::-1], half)
