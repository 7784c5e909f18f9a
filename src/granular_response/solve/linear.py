"""Linear solves with the tangent stiffness: banded where the band is narrow, general sparse LU elsewhere."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from ..core import band
from .state import FloatArray

#: Half-bandwidth (in unknowns) up to which the banded factorisation is the faster one.
WIDEST_BAND = 120
#: Relative residual of a banded solution above which rows are exchanged after all.
ACCEPTED = 1e-6


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution for one right-hand side."""
        ...


def node_order(position: FloatArray, first, second) -> np.ndarray:
    """(n,) order of the disks that keeps neighbours close: along x, or Cuthill-McKee where that is narrower."""
    n = len(position)
    along = np.lexsort((position[:, 1], position[:, 0]))
    if len(first) == 0:
        return along
    ones = np.ones(2 * len(first))
    graph = sp.csr_array((ones, (np.r_[first, second], np.r_[second, first])), shape=(n, n))
    orders = [along, np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True))]
    return min(orders, key=lambda order: _width(order, first, second))


def _width(order, first, second) -> int:
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return int(np.abs(place[first] - place[second]).max())


def sparse_factor(matrix: sp.csc_array, threshold: float = 0.001):
    """SuperLU of a matrix whose pattern is symmetric."""
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options={"SymmetricMode": True})


def symmetric_factor(matrix: sp.csc_array, storage: Band | None) -> tuple[Factor, int]:
    """Factorisation without row exchanges of a symmetric matrix, and its number of negative eigenvalues.

    The pivots have the signs of the eigenvalues (Sylvester's law of inertia).
    """
    if storage is not None:
        factor = storage.factor(matrix)
        return factor, factor.negative_pivots()
    lu = sparse_factor(matrix, 0.0)
    return lu, int((lu.U.diagonal() < 0).sum())


class Band:
    """Banded storage of all matrices with one sparsity pattern (column-compressed)."""

    def __init__(self, indptr, indices, half_width: int):
        n = len(indptr) - 1
        self.half_width = half_width
        self.shape = (n, 2 * half_width + 1)
        column = np.repeat(np.arange(n), np.diff(indptr))
        self._place = indices * self.shape[1] + (column - indices + half_width)

    def factor(self, matrix: sp.csc_array) -> _BandFactor:
        """Factorise a matrix of this pattern."""
        a = np.zeros(self.shape)
        a.ravel()[self._place] = matrix.data
        band.factorise(a, self.half_width)
        return _BandFactor(matrix, a, self.half_width)


class _BandFactor:
    def __init__(self, matrix: sp.csc_array, a: FloatArray, half_width: int):
        self._matrix, self._a, self._half_width = matrix, a, half_width
        self._sparse: Factor | None = None

    def negative_pivots(self) -> int:
        """Number of negative pivots: of negative eigenvalues, for a symmetric matrix."""
        return int((self._a[:, self._half_width] < 0).sum())

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve; falls back to a factorisation with row exchanges when the residual is too large."""
        if self._sparse is None:
            x = right.copy()
            band.solve(self._a, self._half_width, x)
            error = np.abs(self._matrix @ x - right).max()
            if error <= ACCEPTED * np.abs(right).max():
                return x
            self._sparse = sparse_factor(self._matrix)
        return self._sparse.solve(right)
