"""Sparse factorisation for large packings: multifrontal, in the order of a nested dissection.

Each group of disks, or cut between two, is eliminated as one dense front by LAPACK, so nearly all work is matrix
products. What a front leaves for its boundary is added to its parent. Results do not depend on what other libraries
are installed, and every front counts its negative eigenvalues.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.linalg import blas, lapack

from ...state import FloatArray
from . import frontal
from .dissection import Dissection


class Multifrontal:
    """Fronts of all matrices with the pattern of a packing's tangent; ``freedoms`` unknowns for each disk."""

    def __init__(self, dissection: Dissection, freedoms: int):
        def spread(places):
            return (places[:, None] * freedoms + np.arange(freedoms)).ravel()

        self.start = dissection.start * freedoms
        self.boundary = [spread(b) for b in dissection.boundary]
        self.children = dissection.children
        #: for each front where its boundary is in its parent
        self.index: list[np.ndarray] = [np.zeros(0, np.int64)] * len(self.children)
        for front, children in enumerate(self.children):
            own = self.start[front + 1] - self.start[front]
            for child in children:
                later = self.boundary[child]
                inside = later - self.start[front]
                outside = own + np.searchsorted(self.boundary[front], later)
                self.index[child] = np.where(later < self.start[front + 1], inside, outside)
        self._place = np.zeros(self.start[-1], np.int64)

    def factor(self, matrix: sp.csc_array) -> LU:
        """LU with row exchanges inside the fronts."""
        rows = sp.csr_array(matrix)
        updates: dict[int, FloatArray] = {}
        fronts = []
        for front, boundary in enumerate(self.boundary):
            start, stop = self.start[front], self.start[front + 1]
            own, outer = stop - start, len(boundary)
            f11, f21 = np.zeros((own, own), order="F"), np.zeros((outer, own), order="F")
            f12, f22 = np.zeros((own, outer), order="F"), np.zeros((outer, outer), order="F")
            frontal.add_columns(
                matrix.data, matrix.indices, matrix.indptr, start, stop, boundary, self._place, f11, f21
            )
            frontal.add_rows(rows.data, rows.indices, rows.indptr, start, stop, self._place, f12)
            for child in self.children[front]:
                frontal.add_child(updates.pop(child), self.index[child], own, f11, f21, f12, f22)
            f11, pivot, info = lapack.dgetrf(f11, overwrite_a=1)
            if info > 0:
                raise RuntimeError("Factor is exactly singular")
            if outer:
                f12 = lapack.dlaswp(f12, pivot, overwrite_a=1)
                f12 = blas.dtrsm(1.0, f11, f12, lower=1, diag=1, overwrite_b=1)
                f21 = blas.dtrsm(1.0, f11, f21, side=1, overwrite_b=1)
                updates[front] = blas.dgemm(-1.0, f21, f12, beta=1.0, c=f22, overwrite_c=1)
            fronts.append((f11, pivot, f21, f12))
        return LU(self, fronts)

    def symmetric_factor(self, matrix: sp.csc_array) -> tuple[Symmetric, int]:
        """Cholesky factorisation, and L D L^T in fronts that are not positive definite.

        Also returns the number of negative eigenvalues (Sylvester's law of inertia).
        """
        fronts, negative = self._symmetric_fronts(matrix, definite=False)
        return Symmetric(self, fronts), negative

    def definite_factor(self, matrix: sp.csc_array) -> Symmetric | None:
        """Cholesky factorisation; None when the matrix is not positive definite."""
        fronts, negative = self._symmetric_fronts(matrix, definite=True)
        return None if negative else Symmetric(self, fronts)

    def _symmetric_fronts(self, matrix: sp.csc_array, *, definite: bool) -> tuple[list, int]:
        """Factorised fronts and the number of negative eigenvalues; ``definite`` ends at the first one."""
        updates: dict[int, FloatArray] = {}
        fronts: list = []
        negative = 0
        for front, boundary in enumerate(self.boundary):
            start, stop = self.start[front], self.start[front + 1]
            own, outer = stop - start, len(boundary)
            f11, f21 = np.zeros((own, own), order="F"), np.zeros((outer, own), order="F")
            f22 = np.zeros((outer, outer), order="F")
            frontal.add_columns(
                matrix.data, matrix.indices, matrix.indptr, start, stop, boundary, self._place, f11, f21
            )
            for child in self.children[front]:
                frontal.add_child_symmetric(updates.pop(child), self.index[child], own, f11, f21, f22)
            lower, info = lapack.dpotrf(f11, lower=1, clean=0, overwrite_a=definite)
            if info == 0:
                pivot = None
                if outer:
                    f21 = blas.dtrsm(1.0, lower, f21, side=1, lower=1, trans_a=1, overwrite_b=1)
                    f22 = blas.dsyrk(-1.0, f21, beta=1.0, c=f22, lower=1, overwrite_c=1)
            elif definite:
                return fronts, 1
            else:
                lower, pivot, info = lapack.dsytrf(f11, lower=1, overwrite_a=1)
                if info > 0:
                    raise RuntimeError("Factor is exactly singular")
                negative += _negative_blocks(lower, pivot)
                if outer:
                    solved, _ = lapack.dsytrs(lower, pivot, np.asfortranarray(f21.T), lower=1)
                    f22 -= f21 @ solved
                    f21 = np.asfortranarray(solved.T)
            if outer:
                updates[front] = f22
            fronts.append((lower, pivot, f21))
        return fronts, negative


class LU:
    """A factorised matrix."""

    def __init__(self, pattern: Multifrontal, fronts):
        self._pattern, self._fronts = pattern, fronts

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution for one right-hand side."""
        x = right.copy()
        start, boundary = self._pattern.start, self._pattern.boundary
        for front, (f11, pivot, f21, _) in enumerate(self._fronts):
            own = x[start[front] : start[front + 1]]
            own[:] = lapack.dlaswp(own[:, None], pivot)[:, 0]
            own[:] = blas.dtrsv(f11, own, lower=1, diag=1)
            if len(boundary[front]):
                x[boundary[front]] -= f21 @ own
        for front in range(len(self._fronts) - 1, -1, -1):
            f11, _, _, f12 = self._fronts[front]
            own = x[start[front] : start[front + 1]]
            if len(boundary[front]):
                own -= f12 @ x[boundary[front]]
            own[:] = blas.dtrsv(f11, own)
        return x


class Symmetric:
    """A factorised symmetric matrix."""

    def __init__(self, pattern: Multifrontal, fronts):
        self._pattern, self._fronts = pattern, fronts

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution for one right-hand side."""
        x = right.copy()
        start, boundary = self._pattern.start, self._pattern.boundary
        for front, (f11, pivot, f21) in enumerate(self._fronts):
            own = x[start[front] : start[front + 1]]
            if pivot is None:
                own[:] = blas.dtrsv(f11, own, lower=1)
            if len(boundary[front]):
                x[boundary[front]] -= f21 @ own
        for front in range(len(self._fronts) - 1, -1, -1):
            f11, pivot, f21 = self._fronts[front]
            own = x[start[front] : start[front + 1]]
            outer = x[boundary[front]]
            if pivot is None:
                own -= outer @ f21
                own[:] = blas.dtrsv(f11, own, lower=1, trans=1)
            else:
                own[:] = lapack.dsytrs(f11, pivot, own, lower=1)[0]
                own -= outer @ f21
        return x


def _negative_blocks(f11: FloatArray, pivot) -> int:
    """Negative eigenvalues of the block diagonal D of ``dsytrf`` (lower)."""
    diagonal = f11.diagonal()
    # a 2 x 2 block has one eigenvalue of each sign
    return int((diagonal[pivot > 0] < 0).sum()) + int((pivot < 0).sum()) // 2
