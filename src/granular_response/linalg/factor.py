"""What the solvers ask of a factorisation, however it is made."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sp

from ..state import FloatArray


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """The solutions for a right-hand side (n,), or for k of them (k, n)."""
        ...


class Eliminated(Factor, Protocol):
    """A factorised matrix that need not be symmetric."""

    @property
    def negative_pivots(self) -> int:
        """Of U: where their number changes a real eigenvalue may have passed zero."""
        ...


class Renewable(Factor, Protocol):
    """A factorised matrix that can be brought up to date in parts."""

    @property
    def price(self) -> float:
        """About how many solutions cost as much as it."""
        ...

    def renew(self, matrix: sp.csc_array, change: float, most: float) -> bool:
        """Factorise anew where entries have changed by more than ``change``; everywhere else it stays as it was.

        False, and nothing is done, where that would take more than the part ``most`` of the work of all. RuntimeError
        where it is exactly singular; the factorisation is lost then.
        """
        ...


class Storage(Protocol):
    """Factorises all matrices (n, n) of one symmetric sparsity pattern, column-compressed with sorted indices.

    Of a symmetric matrix both triangles are given.
    """

    def factor(self, matrix: sp.csc_array) -> Eliminated:
        """LU of a matrix close to a symmetric one; RuntimeError where it is exactly singular and that is seen."""
        ...

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix (Sylvester's law of inertia)."""
        ...

    def definite_factor(self, matrix: sp.csc_array) -> Factor | None:
        """Factorisation of a symmetric matrix; None when it is not positive definite."""
        ...

    def rough_factor(self, matrix: sp.csc_array) -> Renewable | None:
        """LU that takes half the time, for solutions by iteration; None where there is none (see :mod:`.nearby`)."""
        ...

    def across(self, matrix: sp.csc_array) -> np.ndarray:
        """(e,) for each entry of a matrix the one across the diagonal, found once."""
        ...


class AcrossDiagonal:
    """For each entry (e,) of the matrices of one symmetric pattern the one across the diagonal, found once."""

    def __init__(self) -> None:
        self._found: np.ndarray | None = None

    def __call__(self, matrix: sp.csc_array) -> np.ndarray:
        if self._found is None:
            entries = np.arange(matrix.nnz, dtype=matrix.indices.dtype)
            self._found = sp.csr_array((entries, matrix.indices, matrix.indptr), shape=matrix.shape).tocsc().data
        return self._found
