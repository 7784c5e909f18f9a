"""Vertical stress in an elastic half plane under a vertical point force on its surface.

Depth is measured down from the surface, pressure is positive in compression. The stress function is
homogeneous of degree one in (x, depth), which leaves the closed form below for every orthotropic solid
(Flamant's solution when isotropic).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import check_positive
from .moduli import Moduli


def pressure(x: ArrayLike, depth: float, moduli: Moduli, force: float = 1.0) -> NDArray[np.float64]:
    """Vertical pressure at horizontal distance ``x`` (any shape) and ``depth`` below the force.

    Its integral over x is ``force`` at every depth. Depends on the moduli only through ``Moduli.shape``.
    Raises ValueError if ``depth`` is not positive.
    """
    check_positive(depth=depth)
    s, p = moduli.shape
    t2 = (np.asarray(x, dtype=float) / depth) ** 2
    return force / (np.pi * depth) * np.sqrt(s + 2.0 * np.sqrt(p)) / (1.0 + s * t2 + p * t2**2)
