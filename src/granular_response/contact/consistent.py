"""Whether a contact law agrees with itself: energy, force and stiffness, limit and slope, by finite differences.

A law whose force is not the derivative of its energy comes to rest where no minimum of that energy is, and one with
another stiffness, or slope of its limit, is called stable by the wrong tangent. So each is compared at overlaps from a
millionth to a tenth of a mean radius. At a kink, where the derivative jumps, a law is asked again a little beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numba as nb
import numpy as np

from ..machine.lanes import spread
from .coulomb import limit, limit_slope
from .law import Law, elastic_force, energy, stiffness

#: Overlaps (mean radii), none of them a round number at which a law may have a kink.
OVERLAPS = 1.0137 * np.geomspace(1e-6, 0.1, 11)
#: Half the distance of the two places of a difference, over the overlap, and what it may be off, relatively.
STEP, TOLERANCE = 1e-4, 1e-4
#: Radii of the bodies in contact; None is a wall.
BODIES = ((1.0, 1.0), (0.8, 1.1), (1.0, None))


def contradiction(law: Law) -> str:
    """What in a law contradicts itself, in words; nothing if all its parts belong together."""
    if said := _shapes(law):
        return said
    if not 0.0 < (stiffest := law.stiffest(1.0)) < np.inf:
        return f"stiffest is {stiffest!r} at a force of 1, must be a finite number greater than 0"
    for first, second in BODIES:
        shapes = law.shapes(np.array([first]), None if second is None else np.array([second]))
        shape = None if shapes is None else float(shapes[0])
        for overlap in OVERLAPS.tolist():
            said = _at(law, overlap, shape)
            if said and _at(law, 1.03 * overlap, shape):
                return said
    return ""


def _shapes(law: Law) -> str:
    """The same of its geometry factors: contacts of disks and of walls are in one list, which has them or has none."""
    radii = np.array([first for first, _ in BODIES])
    between, at_wall = law.shapes(radii, radii[::-1]), law.shapes(radii, None)
    if between is None or at_wall is None:
        both = between is at_wall
        return "" if both else "shapes is None for two disks or for a disk and a wall, must be for both or for neither"
    for found in (between, at_wall):
        if np.shape(found) != radii.shape or np.asarray(found).dtype.kind != "f" or not np.isfinite(found).all():
            return f"shapes is {found!r} for {len(radii)} contacts, must be as many finite numbers"
    return ""


def _at(law: Law, overlap: float, shape: float | None) -> str:
    """The same at one overlap."""
    step = STEP * overlap
    low, here, high = (_asked()(law, overlap + k * step, shape) for k in (-1, 0, 1))
    if not np.isfinite([low, here, high]).all():
        return f"energy, elastic_force, stiffness, limit or limit_slope is no finite number at overlap {overlap:.3g}"
    work, force, stiff, most, slope_of_limit = here
    slopes = [(up - down) / (2.0 * step) for down, up in zip(low, high, strict=True)]
    by_force = slopes[3] / slopes[1] if slopes[1] else 0.0
    for name, of, found, slope, scale in (
        ("elastic_force", "energy", force, slopes[0], max(abs(stiff) * overlap, abs(work) / overlap)),
        ("stiffness", "elastic_force", stiff, slopes[1], abs(force) / overlap),
        ("limit_slope", "limit", slope_of_limit, by_force, abs(most / force) if force else 0.0),
    ):
        if abs(found - slope) > TOLERANCE * max(abs(found), abs(slope), scale):
            return f"{name} is {found:.6g} at overlap {overlap:.3g}, where the derivative of {of} is {slope:.6g}"
    return ""


@cache
def _asked() -> Callable:
    """All parts of a law at an overlap, compiled: what they call need not be Python's."""

    @nb.njit(error_model="numpy")
    def asked(law, overlap, shape):
        limit(law, elastic_force(law, spread(overlap), shape))  # dynamics has several contacts at once
        force, stiff = elastic_force(law, overlap, shape), stiffness(law, overlap, shape)
        return energy(law, overlap, shape), force, stiff, limit(law, force), limit_slope(law, force)

    return asked
