"""How wide a response is at a depth, and the power of depth with which that grows.

Profiles are those of a force on the surface, made symmetric, on ``t = x / depth`` from 0 on, and scaled:
``sigma_zz depth / F``. So an elastic half plane has the same profile at every depth, and all widths are per depth.

Two definitions of the width:

* ``half_maximum``: where the profile passes half of its maximum for the last time;
* ``half_force``: the strip within this of the axis bears half of the force.

The root of the second moment is no third one. Under a force on a half plane the stress falls as ``t^-4``, so what lies
beyond a cut-off at t adds to the moment as ``1 / t``: at five depths a quarter of it is still missing. In a packing
that is noise and side walls.
"""

from __future__ import annotations

import numpy as np

from granular_response.observe.widths import last_passage
from granular_response.state import FloatArray

DEFINITIONS = ("half_maximum", "half_force")
#: Depths that are used.
FITS = ("all", "without the shallowest third", "without the deepest third")


def lengths(t: FloatArray, profile: FloatArray) -> FloatArray:
    """(..., definition) widths per depth of scaled profiles (..., len(t)); NaN where there is none.

    The half force is of the whole force, 1, whatever the profile lacks.
    """
    shape, profile = profile.shape[:-1], profile.reshape(-1, len(t))
    found = np.full((len(profile), len(DEFINITIONS)), np.nan)
    strips = 0.5 * (profile[:, 1:] + profile[:, :-1]) * np.diff(t)
    within = np.concatenate([np.zeros((len(profile), 1)), np.cumsum(strips, axis=1)], axis=1)
    for row, (one, force) in enumerate(zip(profile, within, strict=True)):
        if not np.isfinite(one).all() or not one.max() > 0.0:
            continue
        found[row, 0] = last_passage(t, one, 0.5 * one.max())
        beyond = np.flatnonzero(force >= 0.25)  # of one side
        if beyond.size:
            k = int(beyond[0])
            found[row, 1] = t[k - 1] + (0.25 - force[k - 1]) / (force[k] - force[k - 1]) * (t[k] - t[k - 1])
    return found.reshape(*shape, len(DEFINITIONS))


def powers(depth: FloatArray, length: FloatArray) -> FloatArray:
    """(..., fit) powers of ``depth`` (d,) with which lengths (..., d) grow: slopes of the logarithms.

    NaN where a length is missing and with a single depth. The second and the third fit leave out a third of the
    depths at one end: what they differ by is how far this is no power law, or how uncertain.
    """
    third = len(depth) // 3
    parts = (slice(None), slice(third, None), slice(None, len(depth) - third))
    return np.stack([_slope(depth[part], length[..., part]) for part in parts], axis=-1)


def _slope(depth: FloatArray, length: FloatArray) -> FloatArray:
    if len(depth) < 2:
        return np.full(length.shape[:-1], np.nan)
    x = np.log(depth) - np.log(depth).mean()
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.log(length) @ x / (x @ x))
