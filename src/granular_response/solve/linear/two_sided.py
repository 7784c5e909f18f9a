"""Banded LU from both ends, of a tangent of which little changes from one factorisation to the next.

Near a load contacts begin to slide or open, far from it nothing happens. So unknowns are eliminated from both ends of
the band towards a core near the load, and what is left for the rest is kept at checkpoints on the way. Where tangents
of contacts change, the elimination is taken up again at the last checkpoint before them on either side.

Tangents that have changed by less than ``STALE`` of the stiffness are left as they were: the factorisation then belongs
to a matrix nearby, whose Newton steps converge as long as the residual falls, which the caller sees.
"""

from __future__ import annotations

import numpy as np

from ...machine.lanes import WIDTH, less_product, put, spread, take
from ...machine.machine_code import kernel
from ...state import FloatArray
from .band_lu import multiples_of_four, product

#: Change of a contact's tangent, as a part of the normal stiffness, that counts.
STALE = 1e-2
#: Unknowns of a disk.
FREEDOMS = 3
#: Unknowns between two checkpoints, a multiple of the four that are eliminated at once.
SPACING = 48
#: Numbers of a row beyond twice the half-width: the diagonal, and zeros so that nothing before or after it is touched.
PADDED = 1 + 2 * WIDTH


class TwoSided:
    """LU of tangents of one list of contacts.

    Parameters
    ----------
    pairs : (m, 2) places of the disks of each pair in the order of elimination; ``walls`` : (w,) of those at walls.
    arms : (n,) radii by place; each disk has three unknowns, consecutive.
    half_width : of the band, in unknowns; ``centre`` : place where the two eliminations meet.
    diagonal, stiffness : added to the diagonal, and that of a contact.
    """

    def __init__(
        self, pairs, walls, arms: FloatArray, *, half_width: int, centre: int, diagonal: float, stiffness: float
    ):
        disks = len(arms)
        self._pairs, self._walls, self._arms = pairs, walls, arms
        self._touched = pairs, np.stack([walls, walls], axis=1)
        self._b, self._diagonal, self._stale = half_width, diagonal, STALE * stiffness
        core = min(-(-half_width // FREEDOMS), disks)
        first = min(max(centre - core // 2, 0), disks - core)
        #: the first place of the core and the one after its last
        self._core = first, first + core
        #: from the left end and from the right one; both hold rows for the core, the right one what it leaves there
        self._sides = (
            _Side(first * FREEDOMS, core * FREEDOMS, half_width),
            _Side((disks - first - core) * FREEDOMS, core * FREEDOMS, half_width),
        )
        #: tangents of the matrix that is factorised
        self._tangents = np.zeros((len(pairs), 3, 3)), np.zeros((len(walls), 3, 3))
        self._all = True

    def update(self, pair_tangent: FloatArray, wall_tangent: FloatArray) -> bool:
        """Factorise anew what has changed by local tangents (m, 3, 3) and (w, 3, 3); whether anything has."""
        left, right = self._sides
        begin, end = self._core
        changed = np.zeros(2, np.int64)
        if not self._all:
            changed += len(self._arms)
            for disks, tangent, known in zip(self._touched, (pair_tangent, wall_tangent), self._tangents, strict=True):
                _find(disks, tangent, known, self._stale, end, len(self._arms), changed)
            if (changed == len(self._arms)).all():
                return False
        self._all = False
        starts = [side.restart(int(place) * FREEDOMS) for side, place in zip(self._sides, changed, strict=True)]
        _assemble(
            left.rows.ravel(), right.rows.ravel(), self._b, end, len(self._arms), self._arms,
            left.fresh, right.fresh, self._pairs, pair_tangent, self._tangents[0],
            self._walls, wall_tangent, self._tangents[1], self._diagonal,
        )  # fmt: skip
        for side, start in zip(self._sides, starts, strict=True):
            side.eliminate(start)
        _eliminate_core(left.rows.ravel(), right.rows.ravel(), self._b, begin * FREEDOMS, end * FREEDOMS)
        return True

    def forget(self) -> None:
        """Factorise all anew at the next update."""
        self._all = True

    def solve(self, right: FloatArray) -> FloatArray:
        """(n,) the solution; not finite where the matrix has no such factorisation."""
        x = right.copy()
        a, z = self._sides
        _solve(a.rows.ravel(), z.rows.ravel(), self._b, a.stop, z.stop, x, x[::-1].copy())
        if not np.isfinite(x).all():
            self.forget()
        return x


class _Side:
    """Rows of one side from its end on, of which the first ``stop`` are eliminated, and its checkpoints."""

    def __init__(self, stop: int, core: int, half_width: int):
        width = 2 * half_width + PADDED
        self.stop, self._b = stop, half_width
        self.rows = np.zeros((stop + core, width))
        #: what was left for the next rows at each checkpoint, and at the end
        self._windows = np.zeros((stop // SPACING + 2, half_width, width))
        self.fresh = 0

    def restart(self, changed: int) -> int:
        """Where to take up the elimination before unknown ``changed``; rows from ``fresh`` on are cleared."""
        start = (changed - self._b) // SPACING * SPACING
        if start <= 0:
            self.rows[:] = 0.0
            self.fresh = 0
            return 0
        if changed - self._b >= self.stop:
            start, window = self.stop, self._windows[-1]
        else:
            window = self._windows[start // SPACING]
        self.fresh = start + self._b
        self.rows[start : self.fresh] = window[: len(self.rows) - start]
        self.rows[self.fresh :] = 0.0
        return start

    def eliminate(self, start: int) -> None:
        """Eliminate the unknowns ``start ... stop``."""
        _eliminate_side(
            self.rows.ravel(), len(self.rows), self._b, start, self.stop, self._windows.ravel(), len(self._windows)
        )


@kernel
def _find(disks, tangent, known, limit, end, count, changed):
    """Lower ``changed`` to the first place from either end of a contact whose tangent has changed."""
    for c in range(len(disks)):
        near = True
        for a in range(3):
            for b in range(3):
                near &= abs(tangent[c, a, b] - known[c, a, b]) <= limit
        if not near:
            low = min(disks[c, 0], disks[c, 1])
            high = max(disks[c, 0], disks[c, 1])
            if high >= end:
                changed[1] = min(changed[1], count - 1 - high)
            else:
                changed[0] = min(changed[0], low)


@kernel(forceinline=True)
def _add(rows, b, n, mirrored, fresh, at_row, at_column, g, row_sign, row_arm, column_sign, column_arm):
    """Add -L G Z to a block; ``at_row``, ``at_column`` : its first unknowns."""
    width = 2 * b + PADDED
    for p in range(FREEDOMS):
        i = at_row + p
        if mirrored:
            i = n - 1 - i
        if i < fresh:
            continue
        la = -row_arm if p == 2 else row_sign
        for q in range(FREEDOMS):
            j = at_column + q
            if mirrored:
                j = n - 1 - j
            z = column_arm if q == 2 else column_sign
            rows[i * width + b + j - i] -= la * g[p, q] * z


@kernel
def _assemble(
    left, right, b, end, count, arms, fresh_left, fresh_right, pairs, pair_tangent, pair_known,
    walls, wall_tangent, wall_known, diagonal,
):  # fmt: skip
    """Fill the rows from ``fresh`` on; tangents of contacts between such rows become the known ones."""
    n = count * FREEDOMS
    for c in range(len(pairs)):
        i, j = pairs[c, 0], pairs[c, 1]
        low, high = min(i, j), max(i, j)
        mirrored = high >= end
        first = (count - 1 - high if mirrored else low) * FREEDOMS
        last = (count - 1 - low if mirrored else high) * FREEDOMS + FREEDOMS - 1
        fresh = fresh_right if mirrored else fresh_left
        if last < fresh:
            continue
        if first >= fresh:
            for e in range(9):
                pair_known[c, e // 3, e % 3] = pair_tangent[c, e // 3, e % 3]
        g = pair_known[c]
        rows = right if mirrored else left
        ri, rj = arms[i], arms[j]
        i, j = i * FREEDOMS, j * FREEDOMS
        _add(rows, b, n, mirrored, fresh, i, i, g, 1.0, ri, 1.0, ri)
        _add(rows, b, n, mirrored, fresh, i, j, g, 1.0, ri, -1.0, rj)
        _add(rows, b, n, mirrored, fresh, j, i, g, -1.0, rj, 1.0, ri)
        _add(rows, b, n, mirrored, fresh, j, j, g, -1.0, rj, -1.0, rj)
    for c in range(len(walls)):
        i = walls[c]
        mirrored = i >= end
        fresh = fresh_right if mirrored else fresh_left
        first = (count - 1 - i if mirrored else i) * FREEDOMS
        if first + FREEDOMS - 1 < fresh:
            continue
        if first >= fresh:
            for e in range(9):
                wall_known[c, e // 3, e % 3] = wall_tangent[c, e // 3, e % 3]
        ri = arms[i]
        i *= FREEDOMS
        rows = right if mirrored else left
        _add(rows, b, n, mirrored, fresh, i, i, wall_known[c], 1.0, ri, 1.0, ri)
    for i in range(fresh_left, end * FREEDOMS):
        left[i * (2 * b + PADDED) + b] += diagonal
    for i in range(fresh_right, n - end * FREEDOMS):
        right[i * (2 * b + PADDED) + b] += diagonal


@kernel(forceinline=True)
def _four_from_two(a, like, i, j, p0, p1, p2, p3, f0, f1, f2, f3, g0, g1, g2, g3):
    """Subtract multiples of four pivot rows from two rows."""
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


@kernel
def _eliminate(a, b, k, last):
    """Eliminate unknown ``k`` from the rows up to ``last``."""
    stride = 2 * b + PADDED
    pivot = stride * k + b
    inverse = 1.0 / a[pivot]
    like = spread(0.0)
    for i in range(k + 1, last + 1):
        at = stride * i + b - (i - k)
        factor = a[at] * inverse
        a[at] = factor
        if factor != 0.0:
            for c in range(1, b + 1, WIDTH):
                put(a, at + c, less_product(take(a, at + c, like), factor, take(a, pivot + c, like)))


@kernel
def _eliminate_four(a, n, b, k):
    """Eliminate the unknowns ``k ... k + 3`` from all rows, two rows in one pass.

    Beyond the band rows are padded with zeros, so that all rows and columns that any of the four reach are done alike.
    """
    stride = 2 * b + PADDED
    for m in range(3):
        _eliminate(a, b, k + m, k + 3)
    d0 = stride * k + b
    d1, d2, d3 = d0 + stride, d0 + 2 * stride, d0 + 3 * stride
    i0, i1, i2, i3 = 1.0 / a[d0], 1.0 / a[d1], 1.0 / a[d2], 1.0 / a[d3]
    u01, u02, u03, u12, u13, u23 = a[d0 + 1], a[d0 + 2], a[d0 + 3], a[d1 + 1], a[d1 + 2], a[d2 + 1]
    p0, p1, p2, p3 = d0 + 4, d1 + 3, d2 + 2, d3 + 1
    last = min(k + 3 + b, n - 1)
    like = spread(0.0)
    for i in range(k + 4, last + 1, 2):
        x = stride * i + b - (i - k)
        f0, f1, f2, f3 = multiples_of_four(a, x, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23)
        if i == last:
            for c in range(0, b, WIDTH):
                _four_from_two(
                    a, like, x + 4 + c, x + 4 + c, p0 + c, p1 + c, p2 + c, p3 + c, f0, f1, f2, f3, f0, f1, f2, f3
                )  # fmt: skip
            break
        y = x + stride - 1
        g0, g1, g2, g3 = multiples_of_four(a, y, i0, i1, i2, i3, u01, u02, u03, u12, u13, u23)
        for c in range(0, b, WIDTH):
            _four_from_two(
                a, like, x + 4 + c, y + 4 + c, p0 + c, p1 + c, p2 + c, p3 + c, f0, f1, f2, f3, g0, g1, g2, g3
            )  # fmt: skip


@kernel
def _eliminate_range(a, n, b, first, stop):
    """Eliminate the unknowns ``first ... stop``, four by four and what is left one by one."""
    k = first
    while k + 3 < stop:
        _eliminate_four(a, n, b, k)
        k += 4
    while k < stop:
        _eliminate(a, b, k, min(k + b, n - 1))
        k += 1


@kernel
def _keep(rows, b, at, windows, place):
    """Copy ``b`` rows, or those that there are, to a window."""
    stride = 2 * b + PADDED
    for e in range(min(b * stride, len(rows) - at * stride)):
        windows[place * b * stride + e] = rows[at * stride + e]


@kernel
def _eliminate_side(rows, n, b, start, stop, windows, count):
    """Eliminate the unknowns ``start ... stop``, and keep what is left for the next ``b`` rows at checkpoints."""
    for k in range(start, stop, SPACING):
        _keep(rows, b, k, windows, k // SPACING)
        _eliminate_range(rows, n, b, k, min(k + SPACING, stop))
    _keep(rows, b, stop, windows, count - 1)


@kernel
def _eliminate_core(left, right, b, first, last):
    """Add what the right side leaves for the core to that of the left, and factorise it."""
    width = 2 * b + PADDED
    n = first + len(right) // width
    for i in range(first, last):
        for j in range(first, last):
            if abs(j - i) <= b:
                left[i * width + b + j - i] += right[(n - 1 - i) * width + b + i - j]
    _eliminate_range(left, last, b, first, last)


@kernel
def _solve(left, right, b, left_stop, right_stop, x, mirrored):
    """Overwrite ``x`` (n,) with the solution; ``mirrored`` holds it from the other end."""
    width = 2 * b + PADDED
    n = len(x)
    last = n - right_stop
    for i in range(right_stop):
        low = max(0, i - b)
        mirrored[i] -= product(right, width * i + b - i + low, mirrored, low, i - low)
    for i in range(right_stop, min(right_stop + b, n - left_stop)):
        low = max(0, i - b)
        x[n - 1 - i] -= product(right, width * i + b - i + low, mirrored, low, right_stop - low)
    for i in range(last):
        low = max(0, i - b)
        x[i] -= product(left, width * i + b - i + low, x, low, i - low)
    for i in range(last - 1, -1, -1):
        size = min(b, last - 1 - i)
        diagonal = width * i + b
        x[i] = (x[i] - product(left, diagonal + 1, x, i + 1, size)) / left[diagonal]
    for i in range(left_stop, last):
        mirrored[n - 1 - i] = x[i]
    for i in range(right_stop - 1, -1, -1):
        size = min(b, n - left_stop - 1 - i)
        diagonal = width * i + b
        mirrored[i] = (mirrored[i] - product(right, diagonal + 1, mirrored, i + 1, size)) / right[diagonal]
        x[n - 1 - i] = mirrored[i]
