"""Nested dissection: the order of elimination that keeps the fronts of a plane network small.

The nodes are cut in two along the longer side of their box, and again, down to small groups; the nodes along a
cut come after both halves (A. George, SIAM J. Numer. Anal. 10, 345, 1973). In the plane this makes the factors of n
unknowns grow like n log n and their cost like n^1.5.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from ..state import FloatArray

#: Groups of nodes that are not cut any more.
SMALLEST_CUT = 40


class Dissection:
    """Order of elimination of the nodes, and the fronts.

    ``order`` : (n,) nodes in their order. Front ``f`` eliminates the places ``start[f] ... start[f + 1]``;
    ``boundary[f]`` are the later places tied to them, ``children[f]`` the fronts that leave something for it.
    """

    def __init__(self, position: FloatArray, first, second):
        n = len(position)
        ones = np.ones(2 * len(first), np.int8)
        graph = sp.csr_array((ones, (np.r_[first, second], np.r_[second, first])), shape=(n, n))
        reach = np.abs(position[first] - position[second]).max(axis=0, initial=0.0) * (1 + 1e-9)
        neighbours, begin = graph.indices, graph.indptr
        side = np.zeros(n, np.int8)
        groups: list[np.ndarray] = []
        self.children: list[list[int]] = []

        def adjacent(nodes) -> tuple[np.ndarray, np.ndarray]:
            """Neighbours of nodes, and for each the index of the node."""
            count = begin[nodes + 1] - begin[nodes]
            owner = np.repeat(np.arange(len(nodes)), count)
            where = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin[nodes], count)
            return neighbours[where], owner

        def dissect(nodes) -> list[int]:
            """Append the fronts of ``nodes``; returns those that no other one of them follows."""
            if len(nodes) > SMALLEST_CUT:
                box = np.ptp(position[nodes], axis=0)
                along = position[nodes, int(box[1] > box[0])]
                axis = int(box[1] > box[0])
                cut = np.partition(along, len(nodes) // 2)[len(nodes) // 2]
                low = along < cut
                if low.any():
                    side[nodes] = np.where(low, 1, 2)
                    near = nodes[low & (along >= cut - reach[axis])]
                    other, owner = adjacent(near)
                    tied = np.zeros(len(near), bool)
                    tied[owner[side[other] == 2]] = True
                    cut_nodes = near[tied]
                    side[cut_nodes] = 3
                    left = nodes[side[nodes] == 1]
                    right = nodes[~low]
                    side[nodes] = 0
                    below = (dissect(left) if len(left) else []) + dissect(right)
                    if len(cut_nodes) == 0:
                        return below
                    return [add(cut_nodes, below)]
            return [add(nodes, [])]

        def add(nodes, below) -> int:
            groups.append(nodes)
            self.children.append(below)
            return len(groups) - 1

        dissect(np.lexsort((position[:, 1], position[:, 0])))
        self.order = np.concatenate(groups)
        self.start = np.concatenate([[0], np.cumsum([len(g) for g in groups])])
        place = np.empty(n, np.int64)
        place[self.order] = np.arange(n)
        self.boundary: list[np.ndarray] = []
        for front, nodes in enumerate(groups):
            parts = [place[adjacent(nodes)[0]], *(self.boundary[child] for child in self.children[front])]
            later = np.concatenate(parts)
            self.boundary.append(np.unique(later[later >= self.start[front + 1]]))
