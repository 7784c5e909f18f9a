"""Banded factorisations L U without row exchanges.

The tangent of a shallow packing, numbered along its length, has a narrow band. It is close to symmetric and positive,
so rows need not be exchanged, which LAPACK's banded LU cannot leave out; the growth of pivots tells where they must be
after all. Of a symmetric matrix the pivots have the signs of the eigenvalues (Sylvester's law of inertia).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ..machine.lanes import aligned_zeros
from ..state import FloatArray
from . import band_lu
from .factor import Entries, Factor
from .multifrontal import LU

#: Largest pivot over the largest entry of the matrix above which rows are exchanged after all: each digit of it is one
#: that solutions lose (J. H. Wilkinson, J. ACM 8, 281, 1961). It is below 1 in most packings, and reached 2000 where
#: contacts slide.
GROWTH = 1e6


class Band(Entries):
    """Banded storage of all matrices of one pattern."""

    def __init__(self, indptr: np.ndarray, indices: np.ndarray):
        self.n = len(indptr) - 1
        column = np.repeat(np.arange(self.n), np.diff(indptr))
        below = indices - column
        self._b = band_lu.rounded(int(below.max(initial=0)))
        #: (e,) where the entries go in the rows
        self._place = indices * band_lu.stride(self._b) + (self._b - below)

    def factor(self, matrix: sp.csc_array) -> BandLU:
        """LU without row exchanges; they are made up for where a residual asks for them."""
        rows = aligned_zeros(self.n, band_lu.stride(self._b))
        rows.ravel()[self._place] = matrix.data
        band_lu.eliminate(rows.ravel(), self.n, self._b)
        return BandLU(matrix, rows, self._b)

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix."""
        return self.factor(matrix).negative_pivots

    def definite_factor(self, matrix: sp.csc_array) -> BandLU | None:
        """Factorisation; None when the matrix is not positive definite."""
        factor = self.factor(matrix)
        return factor if (factor.pivots > 0.0).all() else None

    def rough_factor(self, matrix: sp.csc_array) -> LU | None:
        """None: an exact one is as cheap."""
        return None


class BandLU:
    """L U of a banded matrix, by rows."""

    def __init__(self, matrix: sp.csc_array, rows: FloatArray, b: int):
        self._matrix, self._rows, self._b = matrix, rows, b

    @property
    def pivots(self) -> FloatArray:
        """(n,) diagonal of U."""
        return self._rows[:, self._b]

    @cached_property
    def negative_pivots(self) -> int:
        """Pivots below zero: where their number changes a real eigenvalue has passed zero.

        At least one where an exact zero on the way has left others without a number.
        """
        negative = int((self.pivots < 0.0).sum())
        return negative if np.isfinite(self.pivots).all() else max(negative, 1)

    def solve(self, right: FloatArray) -> FloatArray:
        """The solutions for (n,) or (k, n); with row exchanges where those without them are no good."""
        rows = np.atleast_2d(right)
        if self._exchanged is None:
            n, b = rows.shape[1], self._b
            room = band_lu.padded(rows, b)
            band_lu.solve(self._rows.ravel(), n, b, room.ravel(), room.shape[1])
            found = room[:, b : b + n]
        else:
            found = np.array([self._exchanged.solve(row) for row in rows])
        return found.reshape(right.shape)

    @cached_property
    def _exchanged(self) -> Factor | None:
        """LU with row exchanges; None where they can be left out."""
        if self.pivots.all() and np.abs(self.pivots).max() <= GROWTH * np.abs(self._matrix.data).max():
            return None
        return splu(self._matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True})
