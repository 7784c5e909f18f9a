"""Linear solves with the tangent stiffness: banded where the band is narrow, multifrontal elsewhere."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from ...state import FloatArray
from . import band
from .multifrontal import Dissection, Multifrontal

#: Half-bandwidth (in unknowns) up to which the banded factorisation is the faster one.
WIDEST_BAND = 120
#: Relative residual of a banded solution above which rows are exchanged after all.
ACCEPTED = 1e-6


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution for one right-hand side."""
        ...


class Storage(Protocol):
    """Where the factors of all matrices with one sparsity pattern go."""

    def factor(self, matrix: sp.csc_array) -> Factor:
        """Factorise; RuntimeError for a matrix that is exactly singular."""
        ...

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[Factor, int]:
        """Factorisation of a symmetric matrix and its number of negative eigenvalues."""
        ...

    def definite_factor(self, matrix: sp.csc_array) -> Factor | None:
        """Factorisation of a symmetric matrix; None when it is not positive definite."""
        ...


def elimination(position: FloatArray, first, second, freedoms: int) -> tuple[np.ndarray, Dissection | None]:
    """(n,) order in which disks are eliminated, and the dissection it comes from where the band is too wide."""
    order = node_order(position, first, second)
    if (_width(order, first, second) + 1) * freedoms - 1 <= WIDEST_BAND:
        return order, None
    dissection = Dissection(position, first, second)
    return dissection.order, dissection


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
    return int(np.abs(place[first] - place[second]).max(initial=0))


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

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[_BandFactor, int]:
        """Factorisation, and the number of negative pivots: of negative eigenvalues (Sylvester's law of inertia)."""
        factor = self.factor(matrix)
        return factor, factor.negative_pivots()

    def definite_factor(self, matrix: sp.csc_array) -> _BandFactor | None:
        """Factorisation of a symmetric matrix; None when it is not positive definite."""
        factor = self.factor(matrix)
        return None if factor.negative_pivots() else factor


class _BandFactor:
    def __init__(self, matrix: sp.csc_array, a: FloatArray, half_width: int):
        self._matrix, self._a, self._half_width = matrix, a, half_width
        self._exchanged: Factor | None = None

    def negative_pivots(self) -> int:
        return int((self._a[:, self._half_width] < 0).sum())

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve; falls back to a factorisation with row exchanges when the residual is too large."""
        if self._exchanged is None:
            x = right.copy()
            band.solve(self._a, self._half_width, x)
            error = np.abs(self._matrix @ x - right).max()
            if error <= ACCEPTED * np.abs(right).max():
                return x
            self._exchanged = splu(
                self._matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True}
            )
        return self._exchanged.solve(right)


__all__ = ["Band", "Dissection", "Factor", "Multifrontal", "Storage", "elimination", "node_order"]
