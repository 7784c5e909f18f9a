"""Where one peak turns into two as the tangential springs weaken, without horizontal springs (Sec. V.C).

The paper estimates it from the half plane and eq. (10). A slab on a rigid floor, and disks that turn
under the tangential forces, each move it; ``stiffness_ratio`` gives all of these cases.
"""

from __future__ import annotations

from typing import Literal

from . import lattice
from .lattice import Rotations, Springs
from .slab import Slab

Body = Literal["half plane", "smooth floor", "rough floor"]


def stiffness_ratio(body: Body = "half plane", rotations: Rotations = "suppressed") -> float:
    """``k2t / k2n`` at which the pressure right below the force turns from a maximum into a minimum.

    0.2915 for the paper's case (the defaults), 0.306 in a slab on a smooth floor; 0.273 and 0.285 if the
    disks turn freely. Raises ValueError for another ``body``.
    """
    if body == "half plane":
        return lattice.peak_criterion_root(rotations)
    if body not in ("smooth floor", "rough floor"):
        raise ValueError(f"body = {body!r}: must be 'half plane', 'smooth floor' or 'rough floor'")

    def curvature(beta: float) -> float:
        moduli = lattice.moduli(Springs(0.0, 1.0, 0.0, beta), rotations)
        return Slab(1.0, moduli, "smooth" if body == "smooth floor" else "rough").curvature_below_force()

    from scipy.optimize import brentq  # a tenth of a second at the start of every process

    return float(brentq(curvature, 0.1, 0.8, xtol=1e-12))
