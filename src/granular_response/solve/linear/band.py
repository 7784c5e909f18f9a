"""Banded factorisations without row exchanges: L U, and L D L^T of a symmetric matrix.

The tangent of a shallow packing, numbered along its length, has a narrow band. It is close to symmetric and positive,
so rows need not be exchanged, which LAPACK's banded LU cannot leave out; a residual tells where they must be after
all. A symmetric positive matrix needs no such care.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ...machine.lanes import aligned_zeros
from ...state import FloatArray
from . import band_ldl, band_lu
from .band_rows import padded, rounded
from .factor import AcrossDiagonal, Factor

#: Relative residual of a banded solution above which rows are exchanged after all.
ACCEPTED = 1e-6


class Band:
    """Banded storage of all matrices with one symmetric sparsity pattern (column-compressed)."""

    def __init__(self, indptr: np.ndarray, indices: np.ndarray):
        self.n = len(indptr) - 1
        self.across = AcrossDiagonal()
        self._column = np.repeat(np.arange(self.n), np.diff(indptr))
        self._below = indices - self._column
        self.half_width = int(self._below.max(initial=0))
        self._b = rounded(self.half_width)

    @cached_property
    def _place(self) -> np.ndarray:
        """(e,) where the entries go in the rows of the LU."""
        return (self._column + self._below) * band_lu.stride(self._b) + (self._b - self._below)

    @cached_property
    def _lower(self) -> tuple[np.ndarray, np.ndarray]:
        """Which entries the factorisation of a symmetric matrix takes, and where they go in its rows."""
        taken = np.flatnonzero(self._below >= 0)
        return taken, (self._column * band_ldl.stride(self._b) + self._below)[taken]

    def factor(self, matrix: sp.csc_array) -> BandLU:
        """LU without row exchanges; they are made up for where a residual asks for them."""
        rows = aligned_zeros(self.n, band_lu.stride(self._b))
        rows.ravel()[self._place] = matrix.data
        band_lu.eliminate(rows.ravel(), self.n, self._b, 0, self.n)
        return BandLU(matrix, rows, self._b)

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[Factor, int]:
        """Factorisation, LU where a pivot is not positive, and the number of negative eigenvalues."""
        rows, _ = self._symmetric(matrix, definite=False)
        factor = BandLDL(rows, self._b) if (rows[:, 0] > 0.0).all() else self.factor(matrix)
        return factor, _negative(rows[:, 0])

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix alone."""
        return _negative(self._symmetric(matrix, definite=False)[0][:, 0])

    def definite_factor(self, matrix: sp.csc_array) -> BandLDL | None:
        """Factorisation; None when the matrix is not positive definite."""
        rows, definite = self._symmetric(matrix, definite=True)
        return BandLDL(rows, self._b) if definite else None

    def _symmetric(self, matrix: sp.csc_array, *, definite: bool) -> tuple[FloatArray, bool]:
        """(n, s) rows of D L^T, and whether they were made to the end: not where one must be definite and is not."""
        rows = aligned_zeros(self.n, band_ldl.stride(self._b))
        taken, place = self._lower
        rows.ravel()[place] = matrix.data[taken]
        return rows, band_ldl.factorise(rows.ravel(), self.n, self._b, definite)

    def rough_factor(self, matrix: sp.csc_array, *, definite: bool) -> None:
        """None: an exact one is as cheap."""
        return None


def _negative(pivots: FloatArray) -> int:
    """How many are negative; at least one where an exact zero on the way has left others without a number."""
    negative = int((pivots < 0.0).sum())
    return negative if np.isfinite(pivots).all() else max(negative, 1)


class BandLU:
    """L U of a banded matrix, by rows."""

    def __init__(self, matrix: sp.csc_array, rows: FloatArray, b: int):
        self._matrix, self._rows, self._b = matrix, rows, b
        self._exchanged: Factor | None = None
        self._tried = False

    @property
    def negative_pivots(self) -> int:
        """Pivots of U below zero: where their number changes a real eigenvalue has passed zero."""
        return int((self._rows[:, self._b] < 0.0).sum())

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution; by a factorisation with row exchanges where that without them is no good."""
        if not self._tried:
            self._tried = True
            # of all unknowns, also of disks that no other right-hand side reaches
            probe = np.where(np.arange(len(right)) % 2, 1.0, -1.0)
            error = np.abs(self._matrix @ self._solve(probe) - probe).max()
            if not error <= ACCEPTED:
                self._exchanged = splu(
                    self._matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True}
                )
        return self._solve(right) if self._exchanged is None else self._exchanged.solve(right)

    def _solve(self, right: FloatArray) -> FloatArray:
        n, b = len(right), self._b
        room = padded(right, b)
        band_lu.solve(self._rows.ravel(), n, b, room)
        return room[b : b + n]


class BandLDL:
    """L D L^T of a symmetric positive banded matrix: rows of D L^T."""

    def __init__(self, rows: FloatArray, b: int):
        self._rows, self._b = rows, b

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution for one right-hand side."""
        n, b = len(right), self._b
        x = padded(right, b)
        band_ldl.solve(self._rows.ravel(), n, b, x)
        return x[b : b + n]
