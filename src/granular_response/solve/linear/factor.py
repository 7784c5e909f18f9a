"""What the solvers ask of a factorisation, however it is made."""

from __future__ import annotations

from typing import Protocol

import scipy.sparse as sp

from ...state import FloatArray


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution for one right-hand side (n,)."""
        ...


class Storage(Protocol):
    """Factorises all matrices (n, n) of one symmetric sparsity pattern, column-compressed with sorted indices.

    Of a symmetric matrix both triangles are given.
    """

    def factor(self, matrix: sp.csc_array) -> Factor:
        """LU of a matrix close to a symmetric one; RuntimeError where it is exactly singular and that is seen."""
        ...

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[Factor, int]:
        """Factorisation of a symmetric matrix and its number of negative eigenvalues (Sylvester's law of inertia)."""
        ...

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix alone: no factorisation is kept."""
        ...

    def definite_factor(self, matrix: sp.csc_array) -> Factor | None:
        """Factorisation of a symmetric matrix; None when it is not positive definite."""
        ...
