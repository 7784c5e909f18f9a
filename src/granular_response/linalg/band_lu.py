"""LU factorisation of banded matrices without row exchanges.

Row ``i`` of ``a`` holds the matrix entries ``(i, i - b) ... (i, i + b)`` and padding, one row after the other. Four
unknowns are eliminated at once from two rows in one pass, which spares memory traffic and keeps the units for fused
products busy: LAPACK's banded LU, which exchanges rows, takes 2.5 times as long, a plain loop seven times.
Nothing is checked: a zero pivot leaves infinities behind, callers check residuals.

The half-width ``b`` is rounded up (:func:`rounded`) and rows are padded with zeros, so that all rows and columns that
four pivots reach are done alike, in whole lanes. Each row begins one column further on than the one before and is one
number longer than a multiple of ``WIDTH``: a column has the same place in a cache line in all of them, so that AVX
registers that begin at a multiple of four columns cross none.

Right-hand sides and solutions have room for ``b`` numbers before them and ``b + PADDING`` behind (:func:`padded`).
"""

from __future__ import annotations

import numpy as np

from ..machine.lanes import WIDTH, less_product, put, spread, take, total
from ..machine.machine_code import kernel
from ..state import FloatArray

#: Zeros behind the numbers of a row. Kernels read up to eight of them and three before a row, which are the last of
#: the row before.
PADDING = 2 * WIDTH


def rounded(half_width: int) -> int:
    """The half-width of the rows that hold a band."""
    return -(-half_width // WIDTH) * WIDTH


def padded(right: FloatArray, b: int) -> FloatArray:
    """A copy of right-hand sides (k, n) that kernels overwrite; each begins at place ``b`` of its row."""
    x = np.zeros((len(right), right.shape[1] + 2 * b + PADDING))
    x[:, b : b + right.shape[1]] = right
    return x


@kernel(forceinline=True)
def _four_from_two(a, like, i, j, pivots, f, g):
    """Subtract multiples of four pivot rows from two rows, which stay in registers while pivot rows pass."""
    first, second = take(a, i, like), take(a, j, like)
    pivot = take(a, pivots[0], like)
    first, second = less_product(first, f[0], pivot), less_product(second, g[0], pivot)
    pivot = take(a, pivots[1], like)
    first, second = less_product(first, f[1], pivot), less_product(second, g[1], pivot)
    pivot = take(a, pivots[2], like)
    first, second = less_product(first, f[2], pivot), less_product(second, g[2], pivot)
    pivot = take(a, pivots[3], like)
    put(a, i, less_product(first, f[3], pivot))
    put(a, j, less_product(second, g[3], pivot))


@kernel(forceinline=True)
def _less_row(value, a, row, x, at, b):
    """``value`` less the scalar product of ``b`` numbers from ``a[row]`` and ``x[at]`` on."""
    like = spread(0.0)
    sums = spread(0.0)
    for c in range(0, b, WIDTH):
        sums = less_product(sums, take(a, row + c, like), take(x, at + c, like))
    return value + total(sums)


@kernel(forceinline=True)
def _less_four_rows(a, row, step, x, at, b):
    """Scalar products of ``b`` numbers from ``a[row]``, ``a[row + step]`` ... and ``x[at]`` on, negative."""
    like = spread(0.0)
    s0, s1, s2, s3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for c in range(0, b, WIDTH):
        v = take(x, at + c, like)
        s0 = less_product(s0, take(a, row + c, like), v)
        s1 = less_product(s1, take(a, row + step + c, like), v)
        s2 = less_product(s2, take(a, row + 2 * step + c, like), v)
        s3 = less_product(s3, take(a, row + 3 * step + c, like), v)
    return total(s0), total(s1), total(s2), total(s3)


@kernel(forceinline=True)
def stride(b):
    """Numbers in a row."""
    return 2 * b + 1 + PADDING


@kernel
def _eliminate(a, b, k, first, last):
    """Eliminate unknown ``k`` from the rows ``first ... last``, the last one too."""
    pivot = stride(b) * k + b
    inverse = 1.0 / a[pivot]
    like = spread(0.0)
    for i in range(first, last + 1):
        at = stride(b) * i + b - (i - k)
        factor = a[at] * inverse
        a[at] = factor
        if factor != 0.0:
            for c in range(1, b + 1, WIDTH):
                put(a, at + c, less_product(take(a, at + c, like), factor, take(a, pivot + c, like)))


@kernel(forceinline=True)
def _multiples(a, at, inverse, above):
    """By which four pivot rows are subtracted from the row whose first unknown of the four is at ``at``: L, kept there.

    ``inverse`` : of the pivots; ``above`` : what stands above the diagonal among the four, row by row, over the pivot
    of its column, so that each multiple waits for one operation after the one before.
    """
    u01, u02, u03, u12, u13, u23 = above
    f0 = a[at] * inverse[0]
    f1 = less_product(a[at + 1] * inverse[1], f0, u01)
    f2 = less_product(less_product(a[at + 2] * inverse[2], f0, u02), f1, u12)
    f3 = less_product(less_product(less_product(a[at + 3] * inverse[3], f0, u03), f1, u13), f2, u23)
    a[at], a[at + 1], a[at + 2], a[at + 3] = f0, f1, f2, f3
    return f0, f1, f2, f3


@kernel
def _eliminate_four(a, n, b, k):
    """Eliminate the unknowns ``k ... k + 3`` from all rows, two rows in one pass."""
    step = stride(b)
    for m in range(3):
        _eliminate(a, b, k + m, k + m + 1, k + 3)
    d0 = step * k + b
    d1, d2, d3 = d0 + step, d0 + 2 * step, d0 + 3 * step
    i0, i1, i2, i3 = 1.0 / a[d0], 1.0 / a[d1], 1.0 / a[d2], 1.0 / a[d3]
    inverse = (i0, i1, i2, i3)
    above = (a[d0 + 1] * i1, a[d0 + 2] * i2, a[d0 + 3] * i3, a[d1 + 1] * i2, a[d1 + 2] * i3, a[d2 + 1] * i3)
    last = min(k + 3 + b, n - 1)
    like = spread(0.0)
    for i in range(k + 4, last, 2):
        x = step * i + b - (i - k)
        y = x + step - 1
        f = _multiples(a, x, inverse, above)
        g = _multiples(a, y, inverse, above)
        for c in range(0, b, WIDTH):
            _four_from_two(a, like, x + 4 + c, y + 4 + c, (d0 + 4 + c, d1 + 3 + c, d2 + 2 + c, d3 + 1 + c), f, g)
    if (last - k) % 2 == 0:  # a row is left
        for m in range(4):
            _eliminate(a, b, k + m, last, last)


@kernel
def eliminate(a, n, b):
    """Overwrite the rows with the factors L (unit diagonal, below) and U, unknowns four by four and the last alone."""
    whole = n - n % 4
    for k in range(0, whole, 4):
        _eliminate_four(a, n, b, k)
    for k in range(whole, n):
        _eliminate(a, b, k, k + 1, min(k + b, n - 1))


@kernel
def _first(x, begin, end):
    """The first number of ``x[begin:end]`` that is not zero, counted from ``begin``."""
    for k in range(begin, end):
        if x[k] != 0.0:
            return k - begin
    return end - begin


@kernel
def solve(a, n, b, x, length):
    """Overwrite each row of ``x`` (:func:`padded`, flat, rows of a ``length``) with the solution y of L U y = x.

    Several in one pass of the factors, each with the digits that it has alone. Nothing is eliminated from the zeros
    that all of them begin with.
    """
    step = stride(b)
    whole = n - n % 4
    begin = n
    for row in range(0, x.size, length):
        begin = min(begin, _first(x, row + b, row + b + n))
    for k in range(begin - begin % 4, whole, 4):
        d0 = step * k + b
        d1, d2, d3 = d0 + step, d0 + 2 * step, d0 + 3 * step
        for at in range(b + k, x.size, length):
            s0, s1, s2, s3 = _less_four_rows(a, d0 - b, step - 1, x, at - b, b)
            x0 = x[at] + s0
            x1 = x[at + 1] + s1 - a[d1 - 1] * x0
            x2 = x[at + 2] + s2 - a[d2 - 2] * x0 - a[d2 - 1] * x1
            x3 = x[at + 3] + s3 - a[d3 - 3] * x0 - a[d3 - 2] * x1 - a[d3 - 1] * x2
            x[at], x[at + 1], x[at + 2], x[at + 3] = x0, x1, x2, x3
    for row in range(0, x.size, length):
        for k in range(whole, n):
            x[row + b + k] = _less_row(x[row + b + k], a, step * k, x, row + k, b)
        for k in range(n - 1, whole - 1, -1):
            d = step * k + b
            x[row + b + k] = _less_row(x[row + b + k], a, d + 1, x, row + b + k + 1, b) / a[d]
    for k in range(whole - 4, -1, -4):
        d0 = step * k + b
        d1, d2, d3 = d0 + step, d0 + 2 * step, d0 + 3 * step
        for at in range(b + k, x.size, length):
            s0, s1, s2, s3 = _less_four_rows(a, d0 + 4, step - 1, x, at + 4, b)
            x3 = (x[at + 3] + s3) / a[d3]
            x2 = (x[at + 2] + s2 - a[d2 + 1] * x3) / a[d2]
            x1 = (x[at + 1] + s1 - a[d1 + 2] * x3 - a[d1 + 1] * x2) / a[d1]
            x0 = (x[at] + s0 - a[d0 + 3] * x3 - a[d0 + 2] * x2 - a[d0 + 1] * x1) / a[d0]
            x[at], x[at + 1], x[at + 2], x[at + 3] = x0, x1, x2, x3
