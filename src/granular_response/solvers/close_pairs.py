"""Pairs of disks that are close to each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernels.neighbours import near
from ..state import FloatArray

IntArray = NDArray[np.int32]

#: Pairs of a disk for which there is room at first: a lattice has 3, and 8 with the second neighbours.
MOST_NEIGHBOURS = 4


def close_pairs(
    position: FloatArray, radius: FloatArray, skin: float, period: float | None = None
) -> tuple[IntArray, IntArray]:
    """All pairs of disks whose gap is less than ``skin``.

    Each disk is compared with those that follow it along the longer side of the packing.

    Parameters
    ----------
    position : (n, 2) disk centres; ``radius`` : (n,); ``skin`` : largest gap listed; ``period`` : of x, if any, wide
        enough for no two disks to meet on both sides.

    Returns
    -------
    first, second : (m,) with ``first < second``, sorted by ``(first, second)``.
    """
    position = np.asarray(position, float)
    farthest = (2.0 * float(radius.max()) + skin) * (1.0 + 1e-12)  # squares of far places overflow
    axis = 0 if period is not None or np.ptp(position[:, 0]) >= np.ptp(position[:, 1]) else 1
    along = position[:, axis]
    if period is not None:
        x = along % period
        along = np.where(x < period, x, 0.0)
    order = np.argsort(along)
    sorted_along, across, size = along[order], position[order, 1 - axis], radius[order]
    count, found = MOST_NEIGHBOURS * len(radius), np.empty((0, 2), np.int64)
    while count > len(found):
        found = np.empty((count, 2), np.int64)
        count = near(sorted_along, across, size, skin, farthest, np.inf if period is None else period, found)
    pair = np.sort(order[found[:count]], axis=1)
    keys = np.sort(pair[:, 0] * len(radius) + pair[:, 1])
    first, second = np.divmod(keys, len(radius))
    return first.astype(np.int32), second.astype(np.int32)
