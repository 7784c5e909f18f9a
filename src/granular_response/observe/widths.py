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
