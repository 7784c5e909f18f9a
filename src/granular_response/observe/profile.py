"""Magnitude of the contact forces against the horizontal position at given depths (Sec. V.D, Fig. 15).

Lengths in mean radii, forces in mean disk weights.
"""

from __future__ import annotations

import numpy as np

from ..state import FloatArray, State
from .difference import pair_force_difference
from .network import contact_centre

#: Distance of neighbouring rows of the triangular lattice, in lattice constants, which are 2.
ROW_SPACING = np.sqrt(3.0) / 2.0


def force_profile(rest: State, loaded: State, loaded_disk: int, depth: float) -> tuple[FloatArray, FloatArray]:
    """``x`` (c,) and |added force| (c,) of the touching pairs centred ``depth`` below the loaded disk.

    ``x`` is measured from the loaded disk, and positions are those of the rest state, so the contacts at a depth are
    the same for every load. Gravity is subtracted as a vector. A contact is taken if it touches in either state and its
    centre is less than a quarter of the row spacing off the depth, which parts the horizontal contacts of row k (at k
    row spacings) from the oblique ones between rows (half a spacing further). Ordered by x, then from the top. Raises
    ``ValueError`` if the states list different candidates.
    """
    magnitude = np.linalg.norm(pair_force_difference(rest, loaded), axis=1)
    offset = rest.box.separation(contact_centre(rest), rest.position[loaded_disk])
    touching = rest.pairs.touching | loaded.pairs.touching
    chosen = np.flatnonzero(touching & (np.abs(-offset[:, 1] - depth) < 0.5 * ROW_SPACING))
    chosen = chosen[np.lexsort((-offset[chosen, 1], offset[chosen, 0]))]
    return offset[chosen, 0], magnitude[chosen]


def row_depth(row: float) -> float:
    """Depth of the ``row``-th row below the loaded disk; oblique contacts lie at half-integer rows."""
    return 2.0 * row * ROW_SPACING
