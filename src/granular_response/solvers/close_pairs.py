"""Pairs of disks that are close to each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..state import FloatArray

IntArray = NDArray[np.int32]


def close_pairs(
    position: FloatArray, radius: FloatArray, skin: float, period: float | None = None
) -> tuple[IntArray, IntArray]:
    """All pairs of disks whose gap is less than ``skin``.

    Parameters
    ----------
    position : (n, 2) disk centres; ``radius`` : (n,); ``skin`` : largest gap listed; ``period`` : of x, if any, wide
        enough for no two disks to meet on both sides.

    Returns
    -------
    first, second : (m,) with ``first < second``, sorted by ``(first, second)``.
    """
    if period is not None:
        x = position[:, 0] % period
        position = np.stack([np.where(x < period, x, 0.0), position[:, 1]], axis=1)
    from scipy.spatial import KDTree  # large packings alone need it; importing takes a twentieth of a second

    tree = KDTree(position, boxsize=None if period is None else [period, 0.0])
    farthest = (2.0 * float(radius.max()) + skin) * (1.0 + 1e-12)
    pairs = tree.query_pairs(farthest, p=np.inf, output_type="ndarray")  # squares of far places overflow
    first, second = np.sort(pairs, axis=1).T
    apart = position[first] - position[second]
    if period is not None:
        apart[:, 0] -= period * np.round(apart[:, 0] / period)
    reach = radius[first] + radius[second] + skin
    close = (apart * apart).sum(axis=1) < reach * reach
    first, second = first[close], second[close]
    order = np.lexsort((second, first))
    return first[order].astype(np.int32), second[order].astype(np.int32)
