"""Transitions of contacts: what each does next on a quasi-static path, from the rates of all displacements.

While every contact keeps its status, displacements are smooth in the load. A contact changes where its overlap or what
is left to Coulomb's limit has fallen to zero; one that slides sticks as soon as its slip would turn round.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..contact.coulomb import limit, limit_slope
from ..contact.law import elastic_force, stiffness
from ..machine.lanes import WIDTH, anywhere, gather, magnitude, put, select, spread, take
from ..machine.machine_code import kernel
from ..state import OPEN, SLIDING, STICKING
from .statics import contact_at, law_of, lever, resistance

#: What a contact does next; ``SLIDES`` is negative where it will slide under a negative force.
NOTHING, OPENS, CLOSES, SLIDES, STICKS = 0, 1, 2, 3, 4


class Changes(NamedTuple):
    """What each of m + w contacts does next in each row (``state.ROWS``)."""

    what: NDArray[Any]
    left: NDArray[Any]  #: force until then (mean weights)
    rate: NDArray[Any]  #: of its fall

    def due(self, force: float) -> NDArray[np.intp]:
        """Contacts that are within a ``force`` of their change."""
        return ((self.rate > 0.0) & (self.left <= force)).nonzero()[0]


class Columns(NamedTuple):
    """A change of the tangent, to be filled: the sum of ``left[k]^T right[k]`` in rows and columns ``places[k]``."""

    owner: NDArray[Any]  #: (r,) whose it is
    places: NDArray[Any]  #: (r, 6)
    left: NDArray[Any]  #: (r, 6)
    right: NDArray[Any]  #: (r, 6)


@kernel(forceinline=True)
def _rates(c, v, nx, nz, listed):
    """Rate at which the contact in place ``c`` of the rows parts, rate of its slip there, and the arm of that."""
    n, at = listed.radius.size, c % listed.gap.size
    i, j = listed.disks[at, 0], listed.disks[at, 1]
    tx, tz, turn, other, arm = lever(c, i, j, nx, nz, listed)
    wx, wz = v[i], v[n + i]
    if j >= 0:
        wx -= v[j]
        wz -= v[n + j]
    slip = wz * tz + wx * tx
    if v.size == 3 * n:
        turned = turn * v[2 * n + i]
        if j >= 0:
            turned += other * v[2 * n + j]
        slip += turned
    return wx * nx + wz * nz, slip, arm


@kernel(forceinline=True)
def _next_to_limit(what, left, rate, status, limit, force, grows, falls, tip, negligible):
    """What contacts do next, if they open so, or do nothing, unless friction makes them do something before.

    ``limit`` : of a ``force`` that grows, if it sticks, while the limit falls.
    """
    slides, against = magnitude(status) > STICKING, status < 0.0
    behind = -(select(against, -grows, grows) + falls)
    back = slides & (behind > negligible)
    for sense in (1.0, -1.0):
        closing = sense * grows + falls
        room = limit - sense * force
        # one that bears nothing slides before it opens
        first = (room <= tip) & (left <= tip) & (closing > rate)
        sooner = (rate <= 0.0) | (room * rate < left * closing) | first
        # with a mask for what may slide at all
        sooner = sooner & (closing > negligible) & (magnitude(status) <= STICKING)
        what, left, rate = (
            select(sooner, sense * SLIDES, what),
            select(sooner, room, left),
            select(sooner, closing, rate),
        )
    return select(back, STICKS, what), select(back, 0.0, left), select(back, behind, rate)


@kernel
def until(c, what, q, v, listed, here):
    """Force that is left until the contact in place ``c`` of the rows does ``what``, and how ``v`` (dof,) lowers it.

    ``q`` (dof,), ``here`` : displacements and :class:`statics.Response` of the trial.
    """
    at = c % here.normal.size
    _, _, nx, nz, _, k = contact_at(at, q, listed)
    unit = law_of(listed, at).normal_stiffness
    apart, slip, arm = _rates(c, v, nx, nz, listed)
    if what == OPENS:
        return unit * here.overlap[at], unit * apart
    if what == CLOSES:
        return -unit * here.overlap[at], -unit * apart
    stiff, most, slope = resistance(c, here.normal[at], listed)
    sense = 1.0 if what > 0 else -1.0
    return most - sense * here.tangential[c], slope * k * apart + sense * (-stiff * arm * slip)


@kernel
def count_ties(listed, status, normal, tip, count):
    """Count in ``count`` (3, n) the ties of each disk, its contacts that bear something, and those that stick.

    A contact ties along its normal and, where it sticks, along the tangent. Where none sticks the turn of the disk
    changes no force.
    """
    ties, bearing, turning = count[0], count[1], count[2]
    size = normal.size
    for c in range(size):
        if status[c] == OPEN:
            continue
        tied = 2 if law_of(listed, c).friction > 0.0 and abs(status[c]) != SLIDING else 1
        if status.size > size and status[size + c] == STICKING:
            tied += 1
        bears = normal[c] > tip
        for end in range(2):
            disk = listed.disks[c, end]
            if disk >= 0:
                ties[disk] += tied
                bearing[disk] += bears
                turning[disk] += tied > 1


@kernel(forceinline=True)
def _next(c, like, rates, law, listed, here, status, tip, negligible, found):
    """Fill in what contact ``c`` does next, or as many from there on as ``like`` has lanes, that is no rattler's.

    ``rates`` : at which it parts and slips. Returns whether one is closed that bears nothing.
    """
    apart, along = rates
    overlap, normal, sense = take(here.overlap, c, like), take(here.normal, c, like), take(status, c, like)
    k, unit = stiffness(law, overlap, take(listed.shape, c, like)), law.normal_stiffness
    is_open, parts = magnitude(sense) <= 0.0, unit * apart
    sign = select(is_open, -1.0, 1.0)
    goes = sign * parts > negligible
    what = select(goes, select(is_open, float(CLOSES), float(OPENS)), 0.0)
    left, rate = select(goes, sign * (unit * overlap), 0.0), select(goes, sign * parts, 0.0)
    if law.friction > 0.0:
        most, grows = limit(law, normal), -law.tangential_stiffness * along
        falls, force = limit_slope(law, normal) * k * apart, take(here.tangential, c, like)
        does, until, speed = _next_to_limit(what, left, rate, sense, most, force, grows, falls, tip, negligible)
        what, left, rate = select(is_open, what, does), select(is_open, left, until), select(is_open, rate, speed)
    put(found.what, c, what)
    put(found.left, c, left)
    put(found.rate, c, rate)
    return anywhere((magnitude(sense) > 0.0) & (normal <= tip))


@kernel
def next_changes(v, listed, here, status, tip, negligible, count, found):
    """Fill ``found`` (:class:`Changes`), as long as ``status`` each.

    ``v`` (dof,) : rates of displacements; ``listed``, ``here`` : :class:`statics.Listed` and :class:`statics.Response`
    of the trial; ``status`` (r (m + w),) of floats : negative for contacts that slide under a negative force;
    ``tip``, ``negligible`` : a force and a rate of a force that are none; ``count`` (3, n) : room to count in.
    A rattler that rests on one contact and that no more ties than it has freedoms, pushed along by another disk, bears
    nothing there however it moves: such a contact opens when the other disk withdraws, and nothing else happens to it.
    """
    radius, disks, size = listed.radius, listed.disks, here.normal.size
    n, like, turns = radius.size, spread(0.0), v.size == 3 * radius.size
    rests = False
    whole = listed.pairs - listed.pairs % WIDTH
    for c in range(0, whole, WIDTH):
        wx = gather(v, 0, disks, c, 0, like) - gather(v, 0, disks, c, 1, like)
        wz = gather(v, n, disks, c, 0, like) - gather(v, n, disks, c, 1, like)
        x, z = take(here.nx, c, like), take(here.nz, c, like)
        along = wz * x - wx * z
        if turns:
            turn = gather(radius, 0, disks, c, 0, like) * gather(v, 2 * n, disks, c, 0, like)
            along = along - (turn + gather(radius, 0, disks, c, 1, like) * gather(v, 2 * n, disks, c, 1, like))
        rates = wx * x + wz * z, along
        rests |= _next(c, like, rates, listed.pair_law, listed, here, status, tip, negligible, found)
    for c in range(whole, size):
        apart, along, _ = _rates(c, v, here.nx[c], here.nz[c], listed)
        rests |= _next(c, 0.0, (apart, along), law_of(listed, c), listed, here, status, tip, negligible, found)
    for r in range(size, status.size):
        c, does, until, speed = r - size, 0.0, 0.0, 0.0
        if status[r] != 0.0:
            k = stiffness(law_of(listed, c), here.overlap[c], take(listed.shape, c, 0.0))
            apart, slip, arm = _rates(r, v, here.nx[c], here.nz[c], listed)
            stiff, most, slope = resistance(r, here.normal[c], listed)
            grows, falls = -stiff * arm * slip, slope * k * apart
            does, until, speed = _next_to_limit(
                does, until, speed, status[r], most, here.tangential[r], grows, falls, tip, negligible
            )
        found.what[r], found.left[r], found.rate[r] = does, until, speed
    if rests:
        _keep_rattlers(v, listed, here, status, tip, negligible, count, found)


@kernel
def _keep_rattlers(v, listed, here, status, tip, negligible, count, found):
    """Let contacts of rattlers that bear nothing do nothing but open, as :func:`next_changes` says."""
    n, disks, size = listed.radius.size, listed.disks, here.normal.size
    freedoms = v.size // n
    count[:, :] = 0
    for i in range(n):
        count[0, i] = listed.loaded[i]
    count_ties(listed, status, here.normal, tip, count)
    for c in range(size):
        if status[c] == 0.0 or here.normal[c] > tip:
            continue
        i, j = disks[c, 0], disks[c, 1]
        first = count[0, i] <= freedoms and count[1, i] <= 1
        if not (first or (j >= 0 and count[0, j] <= freedoms and count[1, j] <= 1)):
            continue
        does, speed = 0.0, 0.0
        if j >= 0:
            # the velocity of the rattler towards the other disk: one that would be drawn along stays behind
            nx, nz = here.nx[c], here.nz[c]
            drawn = -(v[i] * nx + v[n + i] * nz) if first else v[j] * nx + v[n + j] * nz
            if listed.pair_law.normal_stiffness * drawn > negligible:
                does, speed = float(OPENS), listed.pair_law.normal_stiffness * drawn
        for r in range(c, status.size, size):
            found.what[r], found.left[r], found.rate[r] = 0.0, 0.0, 0.0
        found.what[c], found.rate[c] = does, speed


@kernel
def first_change(left, rate):
    """The contact that changes first, and after which growth of the load factor; 0 and infinity where none does."""
    first, length = 0, math.inf
    for c in range(rate.size):
        if rate[c] > 0.0 and max(left[c], 0.0) < length * rate[c]:
            first, length = c, max(left[c], 0.0) / rate[c]
    return first, length


@kernel(forceinline=True)
def _slopes(status, stiff, slope, arm, k):
    """Derivatives of a force, or its couple, by the displacement along n and by the slip; ``k`` : normal stiffness."""
    if status == OPEN:
        return 0.0, 0.0
    if abs(status) == SLIDING:
        return -(slope * (arm if status > 0 else -arm)) * k, 0.0
    return 0.0, -arm * arm * stiff


@kernel
def changed_stiffness(contacts, before, after, q, listed, freedoms, place, columns):
    """Fill rows of ``columns`` (:class:`Columns`) with what other statuses of contacts add to the tangent.

    As many rows as are returned: one where a contact changes between sticking, sliding and open along one direction,
    two where it opens from sticking. ``contacts`` (k,) : places in the rows of which; ``before``, ``after`` : signed
    statuses of all; ``place`` (n,) : of disks in the order of the tangent.
    """
    owner, places, left, right = columns
    size, rows = listed.gap.size, 0
    for c in contacts:
        at = c % size
        i, j, nx, nz, overlap, k = contact_at(at, q, listed)
        normal = elastic_force(law_of(listed, at), max(overlap, 0.0), take(listed.shape, at, 0.0))
        stiff, _, slope = resistance(c, normal, listed)
        tx, tz, turn, other, arm = lever(c, i, j, nx, nz, listed)
        # the force along n, which changes where a contact opens or closes, and that of its row
        for part in range(0 if c < size else 1, 2):
            if part == 0:
                by_n, by_t = (k if before[c] != OPEN else 0.0) - (k if after[c] != OPEN else 0.0), 0.0
            else:
                new_n, new_t = _slopes(after[c], stiff, slope, arm, k)
                old_n, old_t = _slopes(before[c], stiff, slope, arm, k)
                by_n, by_t = new_n - old_n, new_t - old_t
            if by_n == 0.0 and by_t == 0.0:
                continue
            ex, ez = (nx, nz) if part == 0 else (tx, tz)
            rx, rz = by_n * nx + by_t * tx, by_n * nz + by_t * tz
            for e in range(2):
                sign = 1.0 if e == 0 else -1.0
                live = 1.0 if e == 0 or j >= 0 else 0.0
                disk = i if e == 0 or j < 0 else j
                couple = (turn if e == 0 else other) if freedoms == 3 else 0.0
                base = 3 * e
                for a in range(3):
                    places[rows, base + a] = place[disk] * freedoms + min(a, freedoms - 1)
                left[rows, base] = -live * sign * ex
                left[rows, base + 1] = -live * sign * ez
                left[rows, base + 2] = -couple if part == 1 else 0.0
                right[rows, base] = live * sign * rx
                right[rows, base + 1] = live * sign * rz
                right[rows, base + 2] = couple * by_t
            owner[rows] = c
            rows += 1
    return rows
