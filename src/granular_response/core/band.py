"""LU factorisation of banded matrices without row exchanges.

Row ``i`` of ``a`` (n, 2 b + 1) holds the matrix entries ``(i, i - b) ... (i, i + b)``. The tangent of a shallow
packing, numbered along its length, is such a matrix with a narrow band, and close to symmetric and positive: rows
need not be exchanged, and the inner loop is one vectorised row update. A caller checks the residual.
"""

from __future__ import annotations

import numba as nb


@nb.njit(cache=True, error_model="numpy")
def _update(row, pivot_row, factor):
    for j in range(row.size):
        row[j] -= factor * pivot_row[j]


@nb.njit(cache=True, error_model="numpy")
def factorise(a, b):
    """Overwrite ``a`` with its factors L (unit diagonal, below) and U."""
    n = a.shape[0]
    for k in range(n):
        inverse = 1.0 / a[k, b]
        width = min(b, n - 1 - k)
        pivot_row = a[k, b + 1 : b + 1 + width]
        for d in range(1, width + 1):
            i = k + d
            factor = a[i, b - d] * inverse
            a[i, b - d] = factor
            if factor != 0.0:
                _update(a[i, b - d + 1 : b - d + 1 + width], pivot_row, factor)


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
