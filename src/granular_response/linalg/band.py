"""Banded factorisations L U without row exchanges.

The tangent of a shallow packing, numbered along its length, has a narrow band. It is close to symmetric and positive,
so rows need not be exchanged, which LAPACK's banded LU cannot leave out; a residual tells where they must be after
all. Of a symmetric matrix the pivots have the signs of the eigenvalues (Sylvester's law of inertia).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ..machine.lanes import aligned_zeros
from ..state import FloatArray
from . import band_lu
from .factor import AcrossDiagonal, Factor

#: Backward error of a banded solution above which rows are exchanged after all: its residual, over the largest entry of
#: the matrix times that of the solution. Rounding makes 1e-16 of it.
ACCEPTED = 1e-11


class Band:
    """Banded storage of all matrices with one symmetric sparsity pattern (column-compressed)."""

    def __init__(self, indptr: np.ndarray, indices: np.ndarray):
        self.n = len(indptr) - 1
        self.across = AcrossDiagonal()
        column = np.repeat(np.arange(self.n), np.diff(indptr))
        below = indices - column
        self.half_width = int(below.max(initial=0))
        self._b = band_lu.rounded(self.half_width)
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

    def definite_factor(self, matrix: sp.csc_array) -> Factor | None:
        """Factorisation; None when the matrix is not positive definite."""
        factor = self.factor(matrix)
        return factor if (factor.pivots > 0.0).all() else None

    def rough_factor(self, matrix: sp.csc_array) -> None:
        """None: an exact one is as cheap."""
        return None


class BandLU:
    """L U of a banded matrix, by rows."""

    def __init__(self, matrix: sp.csc_array, rows: FloatArray, b: int):
        self._matrix, self._rows, self._b = matrix, rows, b
        self._exchanged: Factor | None = None
        self._tried = False

    @property
    def pivots(self) -> FloatArray:
        """(n,) diagonal of U."""
        return self._rows[:, self._b]

    @property
    def negative_pivots(self) -> int:
        """Pivots below zero: where their number changes a real eigenvalue has passed zero.

        At least one where an exact zero on the way has left others without a number.
        """
        negative = int((self.pivots < 0.0).sum())
        return negative if np.isfinite(self.pivots).all() else max(negative, 1)

    def solve(self, right: FloatArray) -> FloatArray:
        """The solutions for (n,) or (k, n); with row exchanges where those without them are no good."""
        rows = np.atleast_2d(right)
        if self._tried:
            found = self._solve(rows)
        else:
            self._tried = True
            # of all unknowns, also of nodes that no other right-hand side reaches
            probe = np.where(np.arange(rows.shape[1]) % 2, 1.0, -1.0)
            *_, tried = found = self._solve(np.vstack([rows, probe]))
            error = np.abs(self._matrix @ tried - probe).max()
            if not error < ACCEPTED * np.abs(self._matrix.data).max() * np.abs(tried).max():
                self._exchanged = splu(
                    self._matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options={"SymmetricMode": True}
                )
        if self._exchanged is not None:
            found = np.array([self._exchanged.solve(row) for row in rows])
        return found[: len(rows)].reshape(right.shape)

    def _solve(self, right: FloatArray) -> FloatArray:
        n, b = right.shape[1], self._b
        room = band_lu.padded(right, b)
        band_lu.solve(self._rows.ravel(), n, b, room.ravel(), room.shape[1])
        return room[:, b : b + n]
