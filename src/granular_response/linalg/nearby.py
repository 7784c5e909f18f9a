"""Solutions for large packings with a rough factorisation, often that of another matrix: GMRES, preconditioned by it.

Where contacts have changed since a tangent was factorised, the subtrees of fronts that have them are eliminated anew;
everywhere else tangents differ by the little that contacts have turned, which a few products make up for, as they do
for the single precision of the factors (flexible GMRES: Y. Saad, SIAM J. Sci. Comput. 14, 461, 1993). The path of
14,430 disks to 15 mg takes 1.6 times as long with every tangent factorised in double precision.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from ..state import FloatArray
from .factor import Factor
from .multifrontal import LU
from .ordering import Storage


@dataclass(frozen=True)
class NearbyOptions:
    """Numbers by which one factorisation serves other matrices."""

    #: Most products of a solution. A quarter of them shows whether so many will do.
    most: int = 24
    #: Change of an entry, as a part of the largest, from which on its subtree is eliminated anew: the path of 14,430
    #: disks to 15 mg takes 1.9 times as long where none is.
    change: float = 5e-2
    #: Part of the work of a factorisation that this may take.
    most_anew: float = 0.7


OPTIONS = NearbyOptions()


class Sequence:
    """Solutions for one matrix after another of the same packing, with few factorisations.

    A factorisation serves other matrices as long as that pays: not where most of it would have to be made anew, nor
    once a solution takes more products than the average with a new factorisation so far.
    ``same`` : difference of two shifts of the diagonal up to which one serves both.
    """

    def __init__(self, storage: Storage, *, same: float):
        self._storage, self._same, self._shift = storage, same, 0.0
        self.factor: LU | None = None  #: the last factorisation, if the last solution was made with one
        #: what its solutions have cost so far, the first one with the factorisation, their number, and the last one
        self._spent, self._solutions, self._last = 0.0, 0, 0

    def forget(self) -> None:
        """Two factorisations need not be in memory."""
        self.factor = None

    def solve(self, matrix: sp.csc_array, right: FloatArray, tolerance: float, shift: float) -> FloatArray | None:
        """(n,) x with ``|matrix x - right| <= tolerance |right|`` (2-norms); ``shift`` says what is on its diagonal.

        None where an exact factorisation has to tell: in a small packing, where the matrix is singular to the precision
        of a rough one, and where iterations do not converge.
        """
        factor, self.factor, found = self.factor, None, None
        if factor is not None and abs(self._shift - shift) <= self._same:
            try:
                if self._serves(factor, matrix):
                    found = self._iterated(factor, matrix, right, tolerance)
            except RuntimeError:  # a front has become exactly singular
                return None
        if found is None:
            del factor
            factor = self._storage.rough_factor(matrix)
            if factor is None:
                return None
            self._shift, self._spent, self._solutions = shift, factor.price, 0
            found = self._iterated(factor, matrix, right, tolerance)
        self.factor = None if found is None else factor
        return found

    def _serves(self, factor: LU, matrix: sp.csc_array) -> bool:
        """Whether a factorisation serves another matrix, for which it is brought up to date in parts."""
        pays = not (self._solutions and self._last > self._spent / self._solutions)
        return pays and factor.renew(matrix, OPTIONS.change * float(np.abs(matrix.data).max()), OPTIONS.most_anew)

    def _iterated(self, factor: LU, matrix: sp.csc_array, right: FloatArray, tolerance: float) -> FloatArray | None:
        found, self._last = _gmres(matrix, factor, right, tolerance)
        self._spent += self._last
        self._solutions += 1
        return found


def _gmres(matrix: sp.csc_array, factor: Factor, right: FloatArray, tolerance: float) -> tuple[FloatArray | None, int]:
    """The solution, or None, and the number of solutions by the factor.

    These are kept (flexible GMRES): rounded to the precision of the factor, they are not linear in what they are for.
    """
    size = float(np.linalg.norm(right))
    if size == 0.0:
        return np.zeros_like(right), 0
    basis = [right / size]
    solved: list[FloatArray] = []
    triangle = np.zeros((OPTIONS.most, OPTIONS.most))
    turns: list[tuple[float, float]] = []
    left = np.zeros(OPTIONS.most + 1)
    left[0] = size
    for k in range(OPTIONS.most):
        solved.append(factor.solve(basis[k]))
        new = matrix @ solved[k]
        column = np.empty(k + 1)
        for i, direction in enumerate(basis):
            column[i] = direction @ new
            new -= column[i] * direction
        for i, (c, s) in enumerate(turns):
            column[i], column[i + 1] = c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]
        below = float(np.linalg.norm(new))
        length = float(np.hypot(column[k], below))
        if not np.isfinite(length) or length == 0.0:
            return None, k + 1
        turns.append((column[k] / length, below / length))
        triangle[:k, k], triangle[k, k] = column[:k], length
        left[k], left[k + 1] = turns[k][0] * left[k], -turns[k][1] * left[k]
        reduced = abs(left[k + 1]) / size
        if reduced <= tolerance:
            weights = np.linalg.solve(triangle[: k + 1, : k + 1], left[: k + 1])
            total = np.zeros_like(right)
            for weight, direction in zip(weights, solved, strict=True):
                total += weight * direction
            return total, k + 1
        if 4 * (k + 1) >= OPTIONS.most and reduced ** (OPTIONS.most / (k + 1)) > tolerance:
            break
        basis.append(new / below)
    return None, k + 1
