"""LU factorisation of banded matrices without row exchanges.

Row ``i`` of ``a`` (n, 2 b + 1) holds the matrix entries ``(i, i - b) ... (i, i + b)``. The tangent of a shallow
packing, numbered along its length, is such a matrix with a narrow band, and close to symmetric and positive: rows
need not be exchanged, and the inner loop is a vectorised update of one row by four others. Callers check residuals.
"""

from __future__ import annotations

import numba as nb


@nb.njit(cache=True, error_model="numpy")
def _update(row, pivot_row, factor):
    for j in range(row.size):
        row[j] -= factor * pivot_row[j]


@nb.njit(cache=True, error_model="numpy")
def _update_by_four(row, p0, p1, p2, p3, f0, f1, f2, f3):
    """Four updates in one pass: the same operations in the same order on each element."""
    for j in range(row.size):
        row[j] = (((row[j] - f0 * p0[j]) - f1 * p1[j]) - f2 * p2[j]) - f3 * p3[j]


@nb.njit(cache=True, error_model="numpy")
def _eliminate(a, b, k, first, last):
    """Eliminate unknown ``k`` from the rows ``first ... last``."""
    inverse = 1.0 / a[k, b]
    width = min(b, a.shape[0] - 1 - k)
    pivot_row = a[k, b + 1 : b + 1 + width]
    for i in range(first, last):
        at = b - (i - k)
        factor = a[i, at] * inverse
        a[i, at] = factor
        if factor != 0.0:
            _update(a[i, at + 1 : at + 1 + width], pivot_row, factor)


@nb.njit(cache=True, error_model="numpy")
def _eliminate_four(a, b, k):
    """Eliminate the unknowns ``k ... k + 3`` from all rows, each row in one pass, which spares memory traffic."""
    last = a.shape[0] - 1
    for m in range(3):
        _eliminate(a, b, k + m, k + m + 1, k + 4)
    i0, i1, i2, i3 = 1.0 / a[k, b], 1.0 / a[k + 1, b], 1.0 / a[k + 2, b], 1.0 / a[k + 3, b]
    reach = min(k + b, last)  # of all four pivot rows
    width = reach - (k + 3)
    p0, p1 = a[k, b + 4 : b + 4 + width], a[k + 1, b + 3 : b + 3 + width]
    p2, p3 = a[k + 2, b + 2 : b + 2 + width], a[k + 3, b + 1 : b + 1 + width]
    for i in range(k + 4, reach + 1):
        at = b - (i - k)
        f0 = a[i, at] * i0
        f1 = (a[i, at + 1] - f0 * a[k, b + 1]) * i1
        f2 = ((a[i, at + 2] - f0 * a[k, b + 2]) - f1 * a[k + 1, b + 1]) * i2
        f3 = (((a[i, at + 3] - f0 * a[k, b + 3]) - f1 * a[k + 1, b + 2]) - f2 * a[k + 2, b + 1]) * i3
        a[i, at], a[i, at + 1], a[i, at + 2], a[i, at + 3] = f0, f1, f2, f3
        if f0 != 0.0 or f1 != 0.0 or f2 != 0.0 or f3 != 0.0:
            _update_by_four(a[i, at + 4 : at + 4 + width], p0, p1, p2, p3, f0, f1, f2, f3)
        for column in range(reach + 1, min(k + 3 + b, last) + 1):
            place = column - i + b
            value = a[i, place]
            if column <= k + 1 + b:
                value -= f1 * a[k + 1, column - k - 1 + b]
            if column <= k + 2 + b:
                value -= f2 * a[k + 2, column - k - 2 + b]
            a[i, place] = value - f3 * a[k + 3, column - k - 3 + b]
    for m in range(1, 4):
        _eliminate(a, b, k + m, reach + 1, min(k + m + b, last) + 1)


@nb.njit(cache=True, error_model="numpy")
def factorise(a, b):
    """Overwrite ``a`` with its factors L (unit diagonal, below) and U."""
    n = a.shape[0]
    k = 0
    while b >= 4 and k + 3 < n:
        _eliminate_four(a, b, k)
        k += 4
    while k < n:
        _eliminate(a, b, k, k + 1, min(k + b, n - 1) + 1)
        k += 1


@nb.njit(cache=True, error_model="numpy")
def _product(row, x):
    """Scalar product in four partial sums, which may be kept side by side."""
    s0 = s1 = s2 = s3 = 0.0
    whole = row.size - row.size % 4
    for j in range(0, whole, 4):
        s0 += row[j] * x[j]
        s1 += row[j + 1] * x[j + 1]
        s2 += row[j + 2] * x[j + 2]
        s3 += row[j + 3] * x[j + 3]
    for j in range(whole, row.size):
        s0 += row[j] * x[j]
    return (s0 + s1) + (s2 + s3)


@nb.njit(cache=True, error_model="numpy")
def solve(a, b, x):
    """Overwrite ``x`` (n,) with the solution of L U x = x."""
    n = a.shape[0]
    for i in range(n):
        low = max(0, i - b)
        x[i] -= _product(a[i, b - i + low : b], x[low:i])
    for i in range(n - 1, -1, -1):
        high = min(n, i + b + 1)
        x[i] = (x[i] - _product(a[i, b + 1 : b + high - i], x[i + 1 : high])) / a[i, b]
