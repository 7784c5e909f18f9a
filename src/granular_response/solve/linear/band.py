"""Banded factorisations: LU without row exchanges by our own kernels, Cholesky by LAPACK.

The tangent of a shallow packing, numbered along its length, has a narrow band. It is close to symmetric and positive,
so rows of the LU need not be exchanged, which LAPACK's banded LU cannot leave out; a residual tells where they must be
after all. A symmetric positive matrix needs no such care.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.linalg import lapack
from scipy.sparse.linalg import splu

from ...state import FloatArray
from . import band_lu
from .factor import AcrossDiagonal, Factor

#: Relative residual of a banded solution above which rows are exchanged after all.
ACCEPTED = 1e-6


class Band:
    """Banded storage of all matrices with one symmetric sparsity pattern (column-compressed)."""

    def __init__(self, indptr: np.ndarray, indices: np.ndarray):
        n = len(indptr) - 1
        column = np.repeat(np.arange(n), np.diff(indptr))
        below = indices - column
        self.n = n
        self.across = AcrossDiagonal()
        self.half_width = int(below.max(initial=0))
        #: where the entries go in the rows of the LU
        self._place = indices * (2 * self.half_width + 1) + (self.half_width - below)
        #: which entries the Cholesky factorisation takes, and where they go in its columns
        self._lower = np.flatnonzero(below >= 0)
        self._lower_place = (column * (self.half_width + 1) + below)[self._lower]

    def factor(self, matrix: sp.csc_array) -> BandLU:
        """LU without row exchanges; they are made up for where a residual asks for them."""
        rows = np.zeros((self.n, 2 * self.half_width + 1))
        rows.ravel()[self._place] = matrix.data
        band_lu.factorise(rows.ravel(), len(rows), self.half_width)
        return BandLU(matrix, rows, self.half_width)

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[Factor, int]:
        """Cholesky factorisation, LU where that fails, and the number of negative eigenvalues: of negative pivots."""
        definite = self.definite_factor(matrix)
        if definite is not None:
            return definite, 0
        factor = self.factor(matrix)
        return factor, factor.negative_pivots()

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix alone."""
        return self.symmetric_factor(matrix)[1]

    def definite_factor(self, matrix: sp.csc_array) -> BandCholesky | None:
        """Cholesky factorisation; None when the matrix is not positive definite."""
        columns = np.zeros((self.n, self.half_width + 1))
        columns.ravel()[self._lower_place] = matrix.data[self._lower]
        lower, info = lapack.dpbtrf(columns.T, lower=1, overwrite_ab=1)
        return BandCholesky(lower) if info == 0 else None

    def rough_factor(self, matrix: sp.csc_array, *, definite: bool) -> None:
        """None: an exact one is as cheap."""
        return None


class BandLU:
    """L U of a banded matrix, by rows."""

    def __init__(self, matrix: sp.csc_array, rows: FloatArray, half_width: int):
        self._matrix, self._rows, self._half_width = matrix, rows, half_width
        self._exchanged: Factor | None = None

    def negative_pivots(self) -> int:
        """Number of negative pivots, of a symmetric matrix that of its negative eigenvalues."""
        return int((self._rows[:, self._half_width] < 0).sum())

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution; by a factorisation with row exchanges when the residual is too large."""
        if self._exchanged is None:
            x = right.copy()
            band_lu.solve(self._rows.ravel(), len(self._rows), self._half_width, x)
            error = np.abs(self._matrix @ x - right).max()
            if error <= ACCEPTED * np.abs(right).max():
                return x
            self._exchanged = splu(
                self._matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True}
            )
        return self._exchanged.solve(right)


class BandCholesky:
    """Lower factor of a symmetric positive banded matrix, as LAPACK stores it (half_width + 1, n)."""

    def __init__(self, lower: FloatArray):
        self._lower = lower

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution for one right-hand side."""
        return lapack.dpbtrs(self._lower, right, lower=1)[0]
