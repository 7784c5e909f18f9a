"""The least friction with which forces can balance the weights of a pile, whatever its preparation."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_array, csr_array, diags_array, eye_array
from scipy.spatial import cKDTree

from granular_response.scene import PilePacking
from granular_response.studies import bisect_event
from granular_response_paper.records import column, record


@record
class Balance:
    balance: float = column("largest coefficient of friction that was seen to let no forces balance")


def balanced(layers: int, rolling: float, most: float, tolerance: float) -> Balance:
    """Friction, up to ``most``, with which no forces balance the weights of the pile of equal disks as it is placed.

    Normal forces that press, tangential and rolling ones within their limits, at all neighbours and the floor: a linear
    program, which knows neither stiffness nor preparation. No such pile can be at rest below it.
    """
    packing = PilePacking(layers=layers).build()
    pairs = cKDTree(packing.position).query_pairs(2.0 + 1e-6, output_type="ndarray")
    floor, n, p = np.flatnonzero(packing.row == 0), packing.n, len(pairs)
    first, second, m = np.concatenate([pairs[:, 0], floor]), pairs[:, 1], p + len(floor)
    normal = np.tile([0.0, 1.0], (m, 1))
    normal[:p] = 0.5 * (packing.position[first[:p]] - packing.position[second])
    on_first = csr_array((np.ones(m), (first, np.arange(m))), (n, m))
    on_second = csr_array((np.ones(p), (second, np.arange(p))), (n, m))
    apart, one = on_first - on_second, eye_array(m)
    x, z, arm = (diags_array(along) for along in (*normal.T, np.where(np.arange(m) < p, 0.5, 1.0)))
    # forces along x, along z, and turns of the disks by normal, tangential and rolling forces
    equations = block_array(
        [[apart @ x, -apart @ z, None], [apart @ z, apart @ x, None], [None, -on_first - on_second, apart @ arm]]
    )
    weight, bounds = np.repeat([0.0, 1.0, 0.0], n), [(0.0, None)] * m + [(None, None)] * (2 * m)

    def possible(friction: float) -> bool:
        tangential = [[-friction * one, sign * one, None] for sign in (1.0, -1.0)]
        limits = block_array(tangential + [[-rolling * one, None, sign * one] for sign in (1.0, -1.0)])
        found = linprog(np.zeros(3 * m), limits, np.zeros(4 * m), equations, weight, bounds, method="highs")
        return int(found.status) == 0

    return Balance(bisect_event(possible, 0.0, most, tolerance, at_low=False, at_high=True).low)
