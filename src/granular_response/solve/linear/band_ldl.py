"""L D L^T of symmetric banded matrices without row exchanges: half the work of an LU.

Row ``i`` of ``a`` holds ``(i, i) ... (i, i + b)`` and padding (see :mod:`.band_rows`), one row after the other, and
becomes that of D L^T. The signs of the pivots are those of the eigenvalues (Sylvester's law of inertia). LAPACK's
banded Cholesky factorisation calls matrix products as small as the band and takes longer (docs/benchmarks.md).
"""

from __future__ import annotations

from ...machine.lanes import WIDTH, less_product, put, spread, take
from ...machine.machine_code import kernel
from .band_rows import PADDING, backward, four_from_two


@kernel(forceinline=True)
def stride(b):
    """Numbers in a row.

    Lanes that begin up to four columns left of a row's diagonal write into the last numbers of the row before, which
    nothing reads.
    """
    return b + 1 + PADDING + WIDTH


@kernel
def _eliminate(a, b, k, first, last):
    """Eliminate unknown ``k`` from the rows ``first ... last``, the last one too."""
    step = stride(b)
    d = step * k
    inverse = 1.0 / a[d]
    like = spread(0.0)
    for i in range(first, last + 1):
        begin = (i - k) // 4 * 4
        x = step * i + begin - (i - k)
        factor = a[d + i - k] * inverse
        for c in range(0, b + 1 - begin, WIDTH):
            put(a, x + c, less_product(take(a, x + c, like), factor, take(a, d + begin + c, like)))


@kernel
def _eliminate_four(a, n, b, k):
    """Eliminate the unknowns ``k ... k + 3`` from all rows, two rows in one pass."""
    step = stride(b)
    for m in range(3):
        _eliminate(a, b, k + m, k + m + 1, k + 3)
    d0 = step * k
    d1, d2, d3 = d0 + step - 1, d0 + 2 * (step - 1), d0 + 3 * (step - 1)  # where the column of the first pivot would be
    i0, i1, i2, i3 = 1.0 / a[d0], 1.0 / a[d1 + 1], 1.0 / a[d2 + 2], 1.0 / a[d3 + 3]
    last = min(k + 3 + b, n - 1)
    like = spread(0.0)
    for i in range(k + 4, last, 2):
        h = i - k
        f0, f1, f2, f3 = a[d0 + h] * i0, a[d1 + h] * i1, a[d2 + h] * i2, a[d3 + h] * i3
        g0, g1, g2, g3 = a[d0 + h + 1] * i0, a[d1 + h + 1] * i1, a[d2 + h + 1] * i2, a[d3 + h + 1] * i3
        x = step * i - h
        y = x + step - 1
        for c in range(h // 4 * 4, b + 4, WIDTH):
            four_from_two(a, like, x + c, y + c, d0 + c, d1 + c, d2 + c, d3 + c, f0, f1, f2, f3, g0, g1, g2, g3)
    if (last - k) % 2 == 0:  # a row is left
        for m in range(4):
            _eliminate(a, b, k + m, last, last)


@kernel
def factorise(a, n, b, definite):
    """Overwrite the rows with those of D L^T; whether that went to the end.

    ``definite`` : whether to stop at a pivot that is not positive.
    """
    k = 0
    while k < n:
        whole = k + 3 < n
        if whole:
            _eliminate_four(a, n, b, k)
        else:
            _eliminate(a, b, k, k + 1, min(k + b, n - 1))
        size = 4 if whole else 1
        if definite:
            for m in range(k, k + size):
                if not a[stride(b) * m] > 0.0:
                    return False
        k += size
    return True


@kernel
def solve(a, n, b, x):
    """Overwrite ``x`` (:func:`.band_rows.padded`) with the solution y of L D L^T y = x."""
    step = stride(b)
    like = spread(0.0)
    whole = n - n % 4
    for k in range(0, whole, 4):
        d0 = step * k
        d1, d2, d3 = d0 + step, d0 + 2 * step, d0 + 3 * step
        at = b + k
        w0 = x[at] / a[d0]
        x1 = x[at + 1] - a[d0 + 1] * w0
        w1 = x1 / a[d1]
        x2 = x[at + 2] - a[d0 + 2] * w0 - a[d1 + 1] * w1
        w2 = x2 / a[d2]
        x3 = x[at + 3] - a[d0 + 3] * w0 - a[d1 + 2] * w1 - a[d2 + 1] * w2
        w3 = x3 / a[d3]
        x[at + 1], x[at + 2], x[at + 3] = x1, x2, x3
        for c in range(0, b, WIDTH):
            v = take(x, at + 4 + c, like)
            v = less_product(v, w0, take(a, d0 + 4 + c, like))
            v = less_product(v, w1, take(a, d1 + 3 + c, like))
            v = less_product(v, w2, take(a, d2 + 2 + c, like))
            put(x, at + 4 + c, less_product(v, w3, take(a, d3 + 1 + c, like)))
    for k in range(whole, n):
        w = x[b + k] / a[step * k]
        for i in range(k + 1, n):
            x[b + i] -= a[step * k + i - k] * w
    backward(a, step, 0, b, n, x)
