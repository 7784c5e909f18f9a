"""LU factorisation of banded matrices without row exchanges.

Row ``i`` of ``a`` holds the matrix entries ``(i, i - b) ... (i, i + b)`` and padding (see :mod:`.band_rows`), one row
after the other. Four unknowns are eliminated at once from two rows in one pass, which spares memory traffic and keeps
the units for fused products busy. Nothing is checked: a zero pivot leaves infinities behind, callers check residuals.
"""

from __future__ import annotations

from ...machine.lanes import WIDTH, less_product, put, spread, take
from ...machine.machine_code import kernel
from .band_rows import PADDING, backward, four_from_two, less_four_rows, less_row


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
def _multiples(a, at, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23):
    """By which four pivot rows are subtracted from the row whose first unknown of the four is at ``at``: L, kept there.

    ``i0 ...`` : inverses of the pivots; ``u01 ...`` : what stands above the diagonal among the four, over the pivot of
    its column, so that each multiple waits for one operation after the one before.
    """
    f0 = a[at] * i0
    f1 = less_product(a[at + 1] * i1, f0, u01)
    f2 = less_product(less_product(a[at + 2] * i2, f0, u02), f1, u12)
    f3 = less_product(less_product(less_product(a[at + 3] * i3, f0, u03), f1, u13), f2, u23)
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
    u01, u02, u03 = a[d0 + 1] * i1, a[d0 + 2] * i2, a[d0 + 3] * i3
    u12, u13, u23 = a[d1 + 1] * i2, a[d1 + 2] * i3, a[d2 + 1] * i3
    p0, p1, p2, p3 = d0 + 4, d1 + 3, d2 + 2, d3 + 1
    last = min(k + 3 + b, n - 1)
    like = spread(0.0)
    for i in range(k + 4, last, 2):
        x = step * i + b - (i - k)
        y = x + step - 1
        f0, f1, f2, f3 = _multiples(a, x, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23)
        g0, g1, g2, g3 = _multiples(a, y, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23)
        for c in range(0, b, WIDTH):
            four_from_two(
                a, like, x + 4 + c, y + 4 + c, p0 + c, p1 + c, p2 + c, p3 + c, f0, f1, f2, f3, g0, g1, g2, g3
            )  # fmt: skip
    if (last - k) % 2 == 0:  # a row is left
        for m in range(4):
            _eliminate(a, b, k + m, last, last)


@kernel
def eliminate(a, n, b, first, stop):
    """Eliminate the unknowns ``first ... stop`` of ``n``, four by four and what is left one by one.

    Overwritten with the factors L (unit diagonal, below) and U; rows from ``stop`` on with what is left for them.
    """
    k = first
    while k + 3 < stop:
        _eliminate_four(a, n, b, k)
        k += 4
    while k < stop:
        _eliminate(a, b, k, k + 1, min(k + b, n - 1))
        k += 1


@kernel
def forward(a, b, first, stop, x):
    """Overwrite the unknowns ``first ... stop`` of ``x`` (:func:`.band_rows.padded`) with the solution y of L y = x."""
    step = stride(b)
    whole = stop - (stop - first) % 4
    for k in range(first, whole, 4):
        d0 = step * k + b
        d1, d2, d3 = d0 + step, d0 + 2 * step, d0 + 3 * step
        s0, s1, s2, s3 = less_four_rows(a, d0 - b, step - 1, x, k, b)
        x0 = x[b + k] + s0
        x1 = x[b + k + 1] + s1 - a[d1 - 1] * x0
        x2 = x[b + k + 2] + s2 - a[d2 - 2] * x0 - a[d2 - 1] * x1
        x3 = x[b + k + 3] + s3 - a[d3 - 3] * x0 - a[d3 - 2] * x1 - a[d3 - 1] * x2
        x[b + k], x[b + k + 1], x[b + k + 2], x[b + k + 3] = x0, x1, x2, x3
    for k in range(whole, stop):
        x[b + k] = less_row(x[b + k], a, step * k, x, k, b)


@kernel
def solve(a, n, b, x):
    """Overwrite ``x`` (:func:`.band_rows.padded`) with the solution y of L U y = x."""
    forward(a, b, 0, n, x)
    backward(a, stride(b), b, b, n, x)
