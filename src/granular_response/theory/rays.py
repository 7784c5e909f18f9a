"""Pressure on the floor if stress propagates along two rays and diffuses on the way (Sec. II.A, Fig. 1b).

The hyperbolic description in its simplest form: half of the force goes down each of two characteristics
at a fixed angle to the vertical, and disorder widens each ray like a random walk, by the square root of
the depth (refs. [6, 30] of the paper).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import check_positive, require


def pressure(
    x: ArrayLike, depth: float, *, angle: float, diffusion_length: float, force: float = 1.0
) -> NDArray[np.float64]:
    """Vertical pressure at ``x`` (any shape) and ``depth`` below a vertical force; integrates to ``force``.

    ``angle`` is that of the rays to the vertical in radians, in [0, pi/2); ``diffusion_length`` D gives
    each ray the standard deviation ``sqrt(D depth)``. Raises ValueError outside these ranges.
    """
    check_positive(depth=depth, diffusion_length=diffusion_length)
    rule = f"angle = {angle}: must be at least 0 and below pi/2 (to the vertical, in radians)"
    require(0.0 <= angle < np.pi / 2, rule)
    position = np.asarray(x, dtype=float)
    centre, variance = depth * np.tan(angle), diffusion_length * depth
    left = np.exp(-((position + centre) ** 2) / (2.0 * variance))
    right = np.exp(-((position - centre) ** 2) / (2.0 * variance))
    return force * (left + right) / (2.0 * np.sqrt(2.0 * np.pi * variance))
