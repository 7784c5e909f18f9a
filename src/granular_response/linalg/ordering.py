"""The order in which nodes are eliminated, and the kind of factorisation that it calls for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ..state import FloatArray
from .band import Band, BandLU
from .dissection import Dissection
from .multifrontal import LU, Multifrontal

#: Factorises all matrices of one pattern; of a symmetric one both triangles are given.
Storage = Band | Multifrontal
#: L U of any matrix. Where the number of its ``negative_pivots`` changes a real eigenvalue may have passed zero.
Eliminated = BandLU | LU

#: Half-bandwidth (in unknowns) up to which the banded factorisations are the faster ones.
WIDEST_BAND = 130
#: Disks from which on a dissection is remembered: it takes as long as a factorisation.
REMEMBERED = 40_000


@dataclass(frozen=True)
class Elimination:
    """An order of the nodes and the fronts that belong to it, if it is a dissection."""

    order: np.ndarray  #: (n,) nodes in the order in which they are eliminated
    freedoms: int  #: unknowns of each node, consecutive
    dissection: Dissection | None  #: None for a band

    def storage(self, indptr: np.ndarray, indices: np.ndarray) -> Storage:
        """Storage for matrices of this column-compressed pattern, unknowns node by node in :attr:`order`."""
        if self.dissection is None:
            return Band(indptr, indices)
        return Multifrontal(self.dissection, self.freedoms)


def elimination(position: FloatArray, first: np.ndarray, second: np.ndarray, freedoms: int) -> Elimination:
    """The order for nodes at ``position`` (n, 2) that are tied in pairs ``first``, ``second`` (m,).

    A narrow band where there is one, nested dissection elsewhere. Each node has ``freedoms`` unknowns. The last
    dissection of a large network is remembered.
    """
    order = node_order(position, first, second)
    if (_width(order, first, second) + 1) * freedoms - 1 <= WIDEST_BAND:
        return Elimination(order, freedoms, None)
    dissected = _dissected if len(position) > REMEMBERED else _dissected.__wrapped__
    dissection = dissected(np.asarray(position, float).tobytes(), *_packed(first, second))
    return Elimination(dissection.order, freedoms, dissection)


def _packed(*pairs: np.ndarray) -> list[bytes]:
    """Pairs of a network as what can be looked up."""
    return [np.asarray(one, np.int64).tobytes() for one in pairs]


@lru_cache(maxsize=1)
def _dissected(position: bytes, first: bytes, second: bytes) -> Dissection:
    return Dissection(
        np.frombuffer(position).reshape(-1, 2), *(np.frombuffer(one, np.int64) for one in (first, second))
    )


def node_order(position: FloatArray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(n,) order of the nodes that keeps neighbours close: along x, in columns, or by Cuthill-McKee if narrower."""
    n = len(position)
    along = np.lexsort((position[:, 1], position[:, 0]))
    if len(first) == 0:
        return along
    # nodes of a column stand a little askew under their weight, which must not decide their order
    columns = np.lexsort((position[:, 1], np.round(position[:, 0], 1)))
    by_network = _by_network(n, *_packed(first, second))
    return min(along, columns, by_network, key=lambda order: _width(order, first, second))


@lru_cache(maxsize=1)  # from one load to the next the network is the same
def _by_network(n: int, first: bytes, second: bytes) -> np.ndarray:
    """(n,) order by Cuthill-McKee."""
    i, j = np.frombuffer(first, np.int64), np.frombuffer(second, np.int64)
    graph = sp.csr_array((np.ones(2 * len(i)), (np.r_[i, j], np.r_[j, i])), shape=(n, n))
    return np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True))


def _width(order, first, second) -> int:
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return int(np.abs(place[first] - place[second]).max(initial=0))
