"""Ensembles of disordered slabs (Sec. VI), below the groups and the survey: how they are made, smoothed, averaged."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response.observe.floor import smoothed_response
from granular_response.state import FloatArray

#: What becomes of a realization under a load; see ``groups.polydisperse_averages``.
AT_REST, COLLAPSED, FAILED, NOT_REACHED = 0, 1, 2, 3
OUTCOMES = ("at_rest", "collapsed", "failed", "not_reached")


def at_rest(responses: FloatArray, step: int) -> FloatArray:
    """(r, len(x)) responses of the realizations that are at rest at one step."""
    return responses[np.isfinite(responses[:, step, 0]), step]


def smoothed(case: xr.Dataset, x: FloatArray, width: float) -> FloatArray:
    """(realization, step, len(x)) responses of one case with Gaussian coarse graining; nan where not at rest.

    ``case`` has ``x`` (realization, slot), ``floor_response`` (realization, step, slot) and ``outcome`` (realization,
    step); lengths in mean radii, the result in 1/mean radius.
    """
    place = case["x"].transpose("realization", "slot").values
    values = case["floor_response"].transpose("realization", "step", "slot").values
    at_rest = case["outcome"].transpose("realization", "step").values == AT_REST
    found = np.full((*values.shape[:2], len(x)), np.nan)
    for r in range(len(place)):
        known = np.isfinite(place[r]) & np.isfinite(values[r])
        steps = np.flatnonzero(at_rest[r] & known.any(axis=1))
        while steps.size:  # mostly once: floor disks are the same at every step
            here = known[steps[0]]
            alike = (known[steps] == here).all(axis=1)
            used = steps[alike]
            found[r, used] = smoothed_response(x, place[r, here], values[r][np.ix_(used, here)], width)
            steps = steps[~alike]
    return found
