"""Banded LU from both ends, of a tangent of which little changes from one factorisation to the next.

Near a load contacts begin to slide or open, far from it nothing happens. So unknowns are eliminated from both ends of
the band towards a core near the load, and what is left for the rest is kept at checkpoints on the way. Where tangents
of contacts change, the elimination is taken up again at the last checkpoint before them on either side.

Tangents that have changed by less than ``STALE`` of the stiffness are left as they were: the factorisation then belongs
to a matrix nearby, whose Newton steps converge as long as the residual falls, which the caller sees.
"""

from __future__ import annotations

import numpy as np

from ...machine.lanes import aligned_zeros
from ...machine.machine_code import kernel
from ...state import FloatArray
from .band_lu import eliminate, forward, stride
from .band_rows import backward, less_row, padded, rounded

#: Change of a contact's tangent, as a part of the normal stiffness, that counts.
STALE = 1e-2
#: Unknowns of a disk.
FREEDOMS = 3
#: Unknowns between two checkpoints, a multiple of the four that are eliminated at once.
SPACING = 48


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
        self._b, self._diagonal, self._stale = rounded(half_width), diagonal, STALE * stiffness
        core = min(-(-half_width // FREEDOMS), disks)
        first = min(max(centre - core // 2, 0), disks - core)
        #: the first place of the core and the one after its last
        self._core = first, first + core
        #: from the left end and from the right one; both hold rows for the core, the right one what it leaves there
        self._sides = (
            _Side(first * FREEDOMS, core * FREEDOMS, self._b),
            _Side((disks - first - core) * FREEDOMS, core * FREEDOMS, self._b),
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
        a, z = self._sides
        b, last = self._b, len(right) - z.stop
        x, mirrored = padded(right[:last], b), padded(np.zeros(len(z.rows)), b)
        mirrored[b : b + z.stop] = right[: last - 1 : -1]
        _solve(a.rows.ravel(), z.rows.ravel(), b, a.stop, z.stop, last, x, mirrored)
        found = np.concatenate([x[b : b + last], mirrored[b : b + z.stop][::-1]])
        if not np.isfinite(found).all():
            self.forget()
        return found


class _Side:
    """Rows of one side from its end on, of which the first ``stop`` are eliminated, and its checkpoints."""

    def __init__(self, stop: int, core: int, half_width: int):
        self.stop, self._b = stop, half_width
        self.rows = aligned_zeros(stop + core, stride(half_width))
        #: what was left for the next rows at each checkpoint, and at the end
        self._windows = np.zeros((stop // SPACING + 2, half_width, stride(half_width)))
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
    width = stride(b)
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
        left[i * stride(b) + b] += diagonal
    for i in range(fresh_right, n - end * FREEDOMS):
        right[i * stride(b) + b] += diagonal


@kernel
def _keep(rows, b, at, windows, place):
    """Copy ``b`` rows, or those that there are, to a window."""
    width = stride(b)
    for e in range(min(b * width, len(rows) - at * width)):
        windows[place * b * width + e] = rows[at * width + e]


@kernel
def _eliminate_side(rows, n, b, start, stop, windows, count):
    """Eliminate the unknowns ``start ... stop``, and keep what is left for the next ``b`` rows at checkpoints."""
    for k in range(start, stop, SPACING):
        _keep(rows, b, k, windows, k // SPACING)
        eliminate(rows, n, b, k, min(k + SPACING, stop))
    _keep(rows, b, stop, windows, count - 1)


@kernel
def _eliminate_core(left, right, b, first, last):
    """Add what the right side leaves for the core to that of the left, and factorise it."""
    width = stride(b)
    n = first + len(right) // width
    for i in range(first, last):
        for j in range(first, last):
            if abs(j - i) <= b:
                left[i * width + b + j - i] += right[(n - 1 - i) * width + b + i - j]
    eliminate(left, last, b, first, last)


@kernel
def _solve(left, right, b, left_stop, right_stop, last, x, mirrored):
    """Overwrite ``x``, of the left side and the core, and ``mirrored``, of the right one from its end, by the solution.

    Both as :func:`.band_rows.padded` makes them; ``mirrored`` holds zeros for the core. ``last`` : unknowns in ``x``.
    """
    width = stride(b)
    core = last - left_stop
    forward(right, b, 0, right_stop, mirrored)
    for i in range(core):
        row = right_stop + i
        at = b + last - 1 - i
        x[at] = less_row(x[at], right, row * width, mirrored, row, b)
    forward(left, b, 0, last, x)
    backward(left, width, b, b, last, x)
    for i in range(core):
        mirrored[b + right_stop + i] = x[b + last - 1 - i]
    backward(right, width, b, b, right_stop, mirrored)
