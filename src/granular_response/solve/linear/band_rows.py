"""Rows of a banded matrix as the kernels of its factorisations keep them, and what they all do with such rows.

The half-width ``b`` is rounded up (:func:`rounded`) and rows are padded with zeros, so that all rows and columns that
four pivots reach are done alike, in whole lanes. Each row begins one column further on than the one before and is one
number longer than a multiple of ``WIDTH``: a column has the same place in a cache line in all of them, so that AVX
registers that begin at a multiple of four columns cross none.

Right-hand sides and solutions have room for ``b`` numbers before them and ``b + PADDING`` behind (:func:`padded`).
"""

from __future__ import annotations

import numpy as np

from ...machine.lanes import WIDTH, less_product, put, spread, take, total
from ...machine.machine_code import kernel
from ...state import FloatArray

#: Zeros behind the numbers of a row. Kernels read up to eight of them and, in an LU, three before a row, which are the
#: last of the row before.
PADDING = 2 * WIDTH


def rounded(half_width: int) -> int:
    """The half-width of the rows that hold a band."""
    return -(-half_width // WIDTH) * WIDTH


def padded(right: FloatArray, b: int) -> FloatArray:
    """A copy of a right-hand side (n,) that kernels overwrite; it begins at place ``b``."""
    x = np.zeros(len(right) + 2 * b + PADDING)
    x[b : b + len(right)] = right
    return x


@kernel(forceinline=True)
def four_from_two(a, like, i, j, p0, p1, p2, p3, f0, f1, f2, f3, g0, g1, g2, g3):
    """Subtract multiples of four pivot rows from two rows, which stay in registers while pivot rows pass."""
    first, second = take(a, i, like), take(a, j, like)
    pivot = take(a, p0, like)
    first, second = less_product(first, f0, pivot), less_product(second, g0, pivot)
    pivot = take(a, p1, like)
    first, second = less_product(first, f1, pivot), less_product(second, g1, pivot)
    pivot = take(a, p2, like)
    first, second = less_product(first, f2, pivot), less_product(second, g2, pivot)
    pivot = take(a, p3, like)
    put(a, i, less_product(first, f3, pivot))
    put(a, j, less_product(second, g3, pivot))


@kernel(forceinline=True)
def less_row(value, a, row, x, at, b):
    """``value`` less the scalar product of ``b`` numbers from ``a[row]`` and ``x[at]`` on."""
    like = spread(0.0)
    sums = spread(0.0)
    for c in range(0, b, WIDTH):
        sums = less_product(sums, take(a, row + c, like), take(x, at + c, like))
    return value + total(sums)


@kernel(forceinline=True)
def less_four_rows(a, row, step, x, at, b):
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


@kernel
def backward(a, stride, diagonal, b, stop, x):
    """Overwrite the unknowns ``0 ... stop`` of ``x`` (:func:`padded`) with the solution y of U y = x, from the last on.

    ``diagonal`` : place of the diagonal in a row of ``stride`` numbers; the row of U follows it.
    """
    whole = stop - stop % 4
    for i in range(stop - 1, whole - 1, -1):
        d = stride * i + diagonal
        x[b + i] = less_row(x[b + i], a, d + 1, x, b + i + 1, b) / a[d]
    for k in range(whole - 4, -1, -4):
        d0 = stride * k + diagonal
        d1, d2, d3 = d0 + stride, d0 + 2 * stride, d0 + 3 * stride
        s0, s1, s2, s3 = less_four_rows(a, d0 + 4, stride - 1, x, b + k + 4, b)
        x3 = (x[b + k + 3] + s3) / a[d3]
        x2 = (x[b + k + 2] + s2 - a[d2 + 1] * x3) / a[d2]
        x1 = (x[b + k + 1] + s1 - a[d1 + 2] * x3 - a[d1 + 1] * x2) / a[d1]
        x0 = (x[b + k] + s0 - a[d0 + 3] * x3 - a[d0 + 2] * x2 - a[d0 + 1] * x1) / a[d0]
        x[b + k], x[b + k + 1], x[b + k + 2], x[b + k + 3] = x0, x1, x2, x3
