"""Solutions for large packings with a rough factorisation, often that of another matrix: GMRES, preconditioned by it.

Where contacts have changed since a tangent was factorised, the subtrees of fronts that have them are eliminated anew;
everywhere else tangents differ by the little that contacts have turned, which a few products make up for, as they do
for the single precision of the factors. That is far cheaper than to factorise every tangent in double precision.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from ...state import FloatArray
from .factor import Factor, Storage
from .multifrontal import Multifactor

#: Most products of a solution, and the number from which on it is seen whether so many will do.
MOST, SEEN = 24, 6
#: Change of an entry, as a part of the largest, from which on its subtree is eliminated anew.
CHANGE = 5e-2
#: Part of the work of a factorisation that this may take.
MOST_ANEW = 0.7


class Sequence:
    """Solutions for one matrix after another of the same packing, with few factorisations.

    ``definite`` : whether all are symmetric and positive definite, or to be refused. ``same`` : difference of two
    shifts of the diagonal up to which one factorisation serves both.
    """

    def __init__(self, storage: Storage, *, definite: bool, same: float):
        self._storage, self._definite, self._same = storage, definite, same
        self._near: Nearby | None = None
        self._shift = 0.0

    @property
    def factor(self) -> Factor | None:
        """The last factorisation, if the last solution was made with one."""
        return None if self._near is None else self._near.factor

    def forget(self) -> None:
        """Two factorisations need not be in memory."""
        self._near = None

    def solve(self, matrix: sp.csc_array, right: FloatArray, tolerance: float, shift: float) -> FloatArray | None:
        """(n,) x with ``|matrix x - right| <= tolerance |right|`` (2-norms); ``shift`` says what is on its diagonal.

        None where an exact factorisation has to tell: in a small packing, where the matrix is singular or not positive
        definite to the precision of a rough one, and where iterations do not converge.
        """
        near, self._near = self._near, None
        if near is not None and abs(self._shift - shift) <= self._same:
            try:
                found = near.solve(matrix, right, tolerance)
            except RuntimeError:
                return None
            if self._serves(found, right):
                self._near = near
                return found
        del near
        factor = self._storage.rough_factor(matrix, definite=self._definite)
        if factor is None:
            return None
        near = Nearby(factor)
        found = near.solve(matrix, right, tolerance)
        if not self._serves(found, right):
            return None
        self._near, self._shift = near, shift
        return found

    def _serves(self, found: FloatArray | None, right: FloatArray) -> bool:
        """Whether there is a solution, and it is not one that only an indefinite matrix has."""
        return found is not None and not (self._definite and float(found @ right) <= 0.0)


class Nearby:
    """A factorisation that serves other matrices as long as that pays."""

    def __init__(self, factor: Multifactor):
        self.factor = factor
        #: what solutions have cost so far, the first one with the factorisation, and the last one
        self._spent, self._solutions, self._last = factor.price, 0, 0

    def solve(self, matrix: sp.csc_array, right: FloatArray, tolerance: float) -> FloatArray | None:
        """(n,) x with ``|matrix x - right| <= tolerance |right|`` (2-norms).

        None where most of the factorisation would have to be made anew, where ``MOST`` products do not lead there, as
        soon as that is to be expected, and once a solution takes more of them than the average with a new
        factorisation so far. RuntimeError where a front is exactly singular, or not positive definite where it must be.
        """
        if self._solutions and self._last > self._spent / self._solutions:
            return None
        if not self.factor.renew(matrix, CHANGE * float(np.abs(matrix.data).max()), MOST_ANEW):
            return None
        found, self._last = _gmres(matrix, self.factor, right, tolerance)
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
    triangle = np.zeros((MOST, MOST))
    turns: list[tuple[float, float]] = []
    left = np.zeros(MOST + 1)
    left[0] = size
    for k in range(MOST):
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
        if k + 1 >= SEEN and reduced ** (MOST / (k + 1)) > tolerance:
            break
        basis.append(new / below)
    return None, k + 1
