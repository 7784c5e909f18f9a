"""LU factorisation of banded matrices without row exchanges.

Row ``i`` of ``a`` (n, 2 b + 1) holds the matrix entries ``(i, i - b) ... (i, i + b)``. The inner loop is a vectorised
update of one row by four others. Nothing is checked: a zero pivot leaves infinities behind, callers check residuals.
"""

from __future__ import annotations

from ...machine.lanes import WIDTH, put, spread, take
from ...machine.machine_code import kernel


@kernel(forceinline=True)
def _update(a, row, pivot_row, width, factor):
    """Subtract ``factor`` times ``width`` entries from ``pivot_row`` on from those from ``row`` on; ``a`` is flat."""
    whole = width - width % WIDTH
    like = spread(0.0)
    for j in range(0, whole, WIDTH):
        put(a, row + j, take(a, row + j, like) - factor * take(a, pivot_row + j, like))
    for j in range(whole, width):
        put(a, row + j, take(a, row + j, 0.0) - factor * take(a, pivot_row + j, 0.0))


@kernel(forceinline=True)
def _four_from(a, like, row, p0, p1, p2, p3, f0, f1, f2, f3):
    """Four updates in one pass: the same operations in the same order on each element."""
    value = take(a, row, like) - f0 * take(a, p0, like)
    value = value - f1 * take(a, p1, like)
    value = value - f2 * take(a, p2, like)
    put(a, row, value - f3 * take(a, p3, like))


@kernel(forceinline=True)
def _update_by_four(a, row, p0, p1, p2, p3, width, f0, f1, f2, f3):
    whole = width - width % WIDTH
    like = spread(0.0)
    for j in range(0, whole, WIDTH):
        _four_from(a, like, row + j, p0 + j, p1 + j, p2 + j, p3 + j, f0, f1, f2, f3)
    for j in range(whole, width):
        _four_from(a, 0.0, row + j, p0 + j, p1 + j, p2 + j, p3 + j, f0, f1, f2, f3)


@kernel
def _eliminate(a, n, b, k, first, last):
    """Eliminate unknown ``k`` from the rows ``first ... last``; ``a`` is flat."""
    stride = 2 * b + 1
    pivot = stride * k + b
    inverse = 1.0 / a[pivot]
    width = min(b, n - 1 - k)
    for i in range(first, last):
        at = stride * i + b - (i - k)
        factor = a[at] * inverse
        a[at] = factor
        if factor != 0.0:
            _update(a, at + 1, pivot + 1, width, factor)


@kernel(forceinline=True)
def multiples_of_four(a, at, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23):
    """By which four pivot rows are subtracted from the row whose first unknown of the four is at ``at``: L, kept there.

    ``i0 ...`` : inverses of the pivots; ``u01 ...`` : what stands above the diagonal among the four.
    """
    f0 = a[at] * i0
    f1 = (a[at + 1] - f0 * u01) * i1
    f2 = ((a[at + 2] - f0 * u02) - f1 * u12) * i2
    f3 = (((a[at + 3] - f0 * u03) - f1 * u13) - f2 * u23) * i3
    a[at], a[at + 1], a[at + 2], a[at + 3] = f0, f1, f2, f3
    return f0, f1, f2, f3


@kernel
def _eliminate_four(a, n, b, k):
    """Eliminate the unknowns ``k ... k + 3`` from all rows, each row in one pass, which spares memory traffic."""
    stride = 2 * b + 1
    last = n - 1
    for m in range(3):
        _eliminate(a, n, b, k + m, k + m + 1, k + 4)
    d0 = stride * k + b  # the pivots
    d1, d2, d3 = d0 + stride, d0 + 2 * stride, d0 + 3 * stride
    i0, i1, i2, i3 = 1.0 / a[d0], 1.0 / a[d1], 1.0 / a[d2], 1.0 / a[d3]
    reach = min(k + b, last)  # of all four pivot rows
    width = reach - (k + 3)
    u01, u02, u03, u12, u13, u23 = a[d0 + 1], a[d0 + 2], a[d0 + 3], a[d1 + 1], a[d1 + 2], a[d2 + 1]
    for i in range(k + 4, reach + 1):
        at = stride * i + b - (i - k)
        f0, f1, f2, f3 = multiples_of_four(a, at, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23)
        if f0 != 0.0 or f1 != 0.0 or f2 != 0.0 or f3 != 0.0:
            _update_by_four(a, at + 4, d0 + 4, d1 + 3, d2 + 2, d3 + 1, width, f0, f1, f2, f3)
        for column in range(reach + 1, min(k + 3 + b, last) + 1):
            along = column - k
            value = a[at + along]
            if along <= 1 + b:
                value -= f1 * a[d1 + along - 1]
            if along <= 2 + b:
                value -= f2 * a[d2 + along - 2]
            a[at + along] = value - f3 * a[d3 + along - 3]
    for m in range(1, 4):
        _eliminate(a, n, b, k + m, reach + 1, min(k + m + b, last) + 1)


@kernel
def factorise(flat, n, b):
    """Overwrite the rows, one after the other in ``flat``, with the factors L (unit diagonal, below) and U."""
    k = 0
    while b >= 4 and k + 3 < n:
        _eliminate_four(flat, n, b, k)
        k += 4
    while k < n:
        _eliminate(flat, n, b, k, k + 1, min(k + b, n - 1) + 1)
        k += 1


@kernel(forceinline=True)
def product(a, row, x, start, size):
    """Scalar product of ``a[row:]`` and ``x[start:]`` in four partial sums, side by side on any machine."""
    s0 = s1 = s2 = s3 = 0.0
    whole = size - size % 4
    for j in range(0, whole, 4):
        s0 += take(a, row + j, 0.0) * take(x, start + j, 0.0)
        s1 += take(a, row + j + 1, 0.0) * take(x, start + j + 1, 0.0)
        s2 += take(a, row + j + 2, 0.0) * take(x, start + j + 2, 0.0)
        s3 += take(a, row + j + 3, 0.0) * take(x, start + j + 3, 0.0)
    for j in range(whole, size):
        s0 += take(a, row + j, 0.0) * take(x, start + j, 0.0)
    return (s0 + s1) + (s2 + s3)


@kernel
def solve(flat, n, b, x):
    """Overwrite ``x`` (n,) with the solution of L U x = x."""
    for i in range(n):
        low = max(0, i - b)
        diagonal = (2 * b + 1) * i + b
        x[i] -= product(flat, diagonal - i + low, x, low, i - low)
    for i in range(n - 1, -1, -1):
        size = min(b, n - 1 - i)
        diagonal = (2 * b + 1) * i + b
        x[i] = (x[i] - product(flat, diagonal + 1, x, i + 1, size)) / flat[diagonal]
