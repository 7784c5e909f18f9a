"""What factorisations have in common, however they are made."""

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


class Entries:
    """Entries (e,) of the matrices of one symmetric sparsity pattern, column-compressed with sorted indices."""

    _across: np.ndarray | None = None

    def across(self, matrix: sp.csc_array) -> np.ndarray:
        """(e,) for each entry of a matrix the one across the diagonal, found once."""
        if self._across is None:
            entries = np.arange(matrix.nnz, dtype=matrix.indices.dtype)
            self._across = sp.csr_array((entries, matrix.indices, matrix.indptr), shape=matrix.shape).tocsc().data
        return self._across
