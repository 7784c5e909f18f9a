"""Solutions for a matrix that differs in few places from one that has been factorised.

Where few contacts have changed, the matrix is ``K + P Q^T`` with a column for each stiffness that came or went. By the
formula of Sherman, Morrison and Woodbury its solutions are those of K, less a combination of ``K^-1 P``: a change costs
one solution for each column in place of a factorisation (W. W. Hager, SIAM Review 31, 221, 1989). The sign of the
determinant is that of K times that of the capacitance matrix ``C = 1 + Q^T K^-1 P``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..machine.machine_code import kernel
from ..state import FloatArray
from .ordering import Eliminated

#: Pivot of ``C``, or its inverse, from which on half of the digits of a solution are lost.
LEAST = 1e-7


class Updated:
    """A factorised matrix (n, n) and what has changed since: up to ``most`` columns of P and Q.

    ``made`` (k,) says of each key, such as a contact, what it was when the matrix was factorised; a change of it has
    columns of ``entries`` numbers that are not zero.
    """

    def __init__(self, factor: Eliminated, n: int, most: int, entries: int, made: np.ndarray):
        self.factor, self.made = factor, made
        self._solved = np.zeros((most, n))
        self._places = np.zeros((most, entries), np.int64)
        self._right = np.zeros((most, entries))
        self._now = made.copy()  #: (k,) what the columns make of each key
        self._owner = np.full(most, -1)  #: key of each column; -1 where it is free
        self._known: tuple[FloatArray, FloatArray] | None = None
        self._close()

    def update(self, wanted: np.ndarray, change: Callable[[NDArray[np.int64]], tuple]) -> bool:
        """Make each key what it is ``wanted`` to be (k,); False where there is no room.

        ``change(keys)`` gives, for each column that changes add, the key (r,), and places (r, e) and numbers of columns
        of P and Q, (r, e) each.
        """
        differs = wanted != self._now
        keys = np.flatnonzero(differs)
        if not len(keys):
            return True
        self._owner[differs[self._owner]] = -1  # that of a free column may be the last key: it stays free
        self._now[keys] = self.made[keys]
        new = keys[wanted[keys] != self.made[keys]]
        if len(new):
            owner, places, left, right = change(new)
            columns = np.flatnonzero(self._owner < 0)[: len(owner)]
            if len(columns) < len(owner):
                return False
            self._now[new] = wanted[new]
            if len(columns):
                sparse = np.zeros((len(columns), self._solved.shape[1]))
                np.add.at(sparse, (np.arange(len(columns))[:, None], places), left)
                self._solved[columns] = self.factor.solve(sparse)
                self._places[columns], self._right[columns], self._owner[columns] = places, right, owner
        self._close()
        return True

    def _close(self) -> None:
        self._order = np.flatnonzero(self._owner >= 0)
        self._capacitance = np.empty((len(self._order), len(self._order)))
        self._weights = np.empty(len(self._order))
        negative, smallest, largest = _factorise(
            self._order, self._places, self._right, self._solved, self._capacitance
        )
        #: Of the factorisation and of ``C``: where their number changes a real eigenvalue may have passed zero.
        self.negative_pivots = self.factor.negative_pivots + negative
        #: whether solutions keep half of their digits: not where a change takes hold of what nothing held before
        self.accurate = smallest > LEAST and largest < 1.0 / LEAST

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution for one right-hand side (n,)."""
        return self._corrected(self.factor.solve(right))

    def solve_same(self, right: FloatArray) -> FloatArray:
        """As :meth:`solve`, for a right-hand side that stays the same array: its solution by K is kept."""
        if self._known is None or self._known[0] is not right:
            self._known = right, self.factor.solve(right)
        return self._corrected(self._known[1].copy())

    def _corrected(self, x: FloatArray) -> FloatArray:
        if len(self._order):
            _correct(x, self._order, self._places, self._right, self._solved, self._capacitance, self._weights)
        return x


@kernel
def _factorise(order, places, right, solved, c):
    """Fill ``c`` with L and U of ``C``; the number of negative pivots, the smallest and the largest in size."""
    size = order.size
    for i in range(size):
        row = order[i]
        for j in range(size):
            total = 1.0 if i == j else 0.0
            for e in range(places.shape[1]):
                total += right[row, e] * solved[order[j], places[row, e]]
            c[i, j] = total
    negative, smallest, largest = 0, 1.0, 1.0
    for k in range(size):
        pivot = c[k, k]
        negative += pivot < 0.0
        smallest, largest = min(smallest, abs(pivot)), max(largest, abs(pivot))
        for i in range(k + 1, size):
            c[i, k] /= pivot
            for j in range(k + 1, size):
                c[i, j] -= c[i, k] * c[k, j]
    return negative, smallest, largest


@kernel
def _correct(x, order, places, right, solved, c, weights):
    """Overwrite ``x``, a solution by K, with that by ``K + P Q^T``."""
    size = order.size
    for i in range(size):
        total = 0.0
        for e in range(places.shape[1]):
            total += right[order[i], e] * x[places[order[i], e]]
        for j in range(i):
            total -= c[i, j] * weights[j]
        weights[i] = total
    for i in range(size - 1, -1, -1):
        for j in range(i + 1, size):
            weights[i] -= c[i, j] * weights[j]
        weights[i] /= c[i, i]
    for i in range(size):
        row, weight = order[i], weights[i]
        for k in range(x.size):
            x[k] -= weight * solved[row, k]
