"""What each contact does next on a quasi-static path, from the rates of all displacements.

While every contact keeps its status, displacements are smooth in the load. A contact changes where its overlap or what
is left to Coulomb's limit has fallen to zero; one that slides sticks as soon as its slip would turn round.
"""

from __future__ import annotations

import math

from ..contact.law import stiffness
from ..machine.lanes import WIDTH, anywhere, gather, magnitude, put, select, spread, take
from ..machine.machine_code import kernel
from ..state import OPEN, SLIDING, STICKING
from .statics import _contact_at

#: What a contact does next; ``SLIDES`` is negative where it will slide under a negative force.
NOTHING, OPENS, CLOSES, SLIDES, STICKS = 0, 1, 2, 3, 4


@kernel(forceinline=True)
def _motion(v, i, j, nx, nz, n, radius):
    """Rates of the relative displacement along the normal and, less the rolling, along the tangent."""
    wx, wz = v[i], v[n + i]
    if j >= 0:
        wx -= v[j]
        wz -= v[n + j]
    along = wz * nx - wx * nz
    if v.size == 3 * n:
        turn = radius[i] * v[2 * n + i]
        if j >= 0:
            turn += radius[j] * v[2 * n + j]
        along -= turn
    return wx * nx + wz * nz, along


@kernel(forceinline=True)
def _rolling_rates(c, v, i, j, apart, k, n, rolls):
    """Rate of the rolling force of contact ``c``, if it sticks, and of the fall of its limit."""
    spin = v[2 * n + i] - v[2 * n + j] if j >= 0 else v[2 * n + i]
    return -rolls.stiffness[c] * rolls.arm[c] * spin, rolls.friction[c] * k * apart


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
def until(c, what, q, v, n, radius, pairs, walls, rolls, normal, tangential, rolling, overlap):
    """Force that is left until contact ``c`` does ``what``, and by how much displacements ``v`` (dof,) lower it.

    From m + w on, where rolling resistance goes on counting, along the rolling. The rest as of :func:`next_changes`.
    """
    at = c % normal.size
    i, j, nx, nz, k, unit, mu, kt = _contact_at(at, q, n, pairs, walls)
    apart, along = _motion(v, i, j, nx, nz, n, radius)
    if what == OPENS:
        return unit * overlap[at], unit * apart
    if what == CLOSES:
        return -unit * overlap[at], -unit * apart
    force, grows, falls = tangential[at], -kt * along, mu * k * apart
    if rolls is not None and c > at:
        mu, force = rolls.friction[at], rolling[at]
        grows, falls = _rolling_rates(at, v, i, j, apart, k, n, rolls)
    sense = 1.0 if what > 0 else -1.0
    return mu * normal[at] - sense * force, falls + sense * grows


@kernel
def count_ties(pairs, walls, rolls, status, normal, tip, count):
    """Count in ``count`` (3, n) the ties of each disk, its contacts that bear something, and those that stick.

    A contact ties along its normal and, where it sticks, along the tangent. Where none sticks the turn of the disk
    changes no force.
    """
    ties, bearing, turning = count[0], count[1], count[2]
    m = pairs.first.size
    size = m + walls.disk.size
    for c in range(size):
        if status[c] == OPEN:
            continue
        mu = pairs.law.friction if c < m else walls.law.friction
        tied = 2 if mu > 0.0 and abs(status[c]) != SLIDING else 1
        if rolls is not None and status[size + c] == STICKING:
            tied += 1
        bears = normal[c] > tip
        sticks = tied > 1
        i = pairs.first[c] if c < m else walls.disk[c - m]
        ties[i] += tied
        bearing[i] += bears
        turning[i] += sticks
        if c < m:
            ties[pairs.second[c]] += tied
            bearing[pairs.second[c]] += bears
            turning[pairs.second[c]] += sticks


@kernel(forceinline=True)
def _next(status, apart, along, overlap, normal, tangential, k, law, tip, negligible):
    """What contacts of a law do next that are not those of a rattler, for numbers or for vectors of them."""
    unit = law.normal_stiffness
    is_open, parts = magnitude(status) <= 0.0, unit * apart
    sense = select(is_open, -1.0, 1.0)
    goes = sense * parts > negligible
    what = select(goes, select(is_open, float(CLOSES), float(OPENS)), 0.0)
    left, rate = select(goes, sense * (unit * overlap), 0.0), select(goes, sense * parts, 0.0)
    if law.friction > 0.0:
        mu, kt = law.friction, law.tangential_stiffness
        does, until, speed = _next_to_limit(
            what, left, rate, status, mu * normal, tangential, -kt * along, mu * k * apart, tip, negligible
        )
        what, left, rate = select(is_open, what, does), select(is_open, left, until), select(is_open, rate, speed)
    return what, left, rate


@kernel
def next_changes(
    v, n, radius, pairs, pair_shape, walls, rolls, nx, nz, normal, tangential, rolling, overlap, status, tip,
    negligible, loaded, table, count, what, left, rate,
):  # fmt: skip
    """Fill ``what``, ``left`` (mean weights) and ``rate`` (of the fall of ``left``), as long as ``status`` each.

    ``v`` (dof,) : rates of displacements; ``rolls`` : ``statics.Rolls`` or None; ``nx``, ``nz``, ``normal``,
    ``tangential``, ``rolling``, ``overlap`` (m + w,) : normals and forces, the rolling ones None without; ``status``
    (m + w,), or twice as many with rolling resistance, of floats : negative for contacts that slide under a negative
    force; ``tip``, ``negligible`` : a force and a rate of a force that are none; ``loaded`` (n,) : ties that loads
    count as, more than a disk has freedoms; ``table`` (m, 2) : disks of the pairs; ``count`` (3, n) : room to count in.
    A rattler that rests on one contact and that no more ties than it has freedoms, pushed along by another disk, bears
    nothing there however it moves: such a contact opens when the other disk withdraws, and nothing else happens to it.

    Returns how many are within ``tip`` of their change.
    """
    size, m = normal.size, pairs.first.size
    like, turns = spread(0.0), v.size == 3 * n
    rests = False
    whole = m - m % WIDTH
    for c in range(0, whole, WIDTH):
        wx = gather(v, 0, table, c, 0) - gather(v, 0, table, c, 1)
        wz = gather(v, n, table, c, 0) - gather(v, n, table, c, 1)
        x, z = take(nx, c, like), take(nz, c, like)
        along = wz * x - wx * z
        if turns:
            turn = gather(radius, 0, table, c, 0) * gather(v, 2 * n, table, c, 0)
            along = along - (turn + gather(radius, 0, table, c, 1) * gather(v, 2 * n, table, c, 1))
        xi, fn, sense = take(overlap, c, like), take(normal, c, like), take(status, c, like)
        rests = rests or anywhere((magnitude(sense) > 0.0) & (fn <= tip))
        k = stiffness(pairs.law, xi, take(pair_shape, c, like))
        does, until, speed = _next(
            sense, wx * x + wz * z, along, xi, fn, take(tangential, c, like), k, pairs.law, tip, negligible
        )
        put(what, c, does)
        put(left, c, until)
        put(rate, c, speed)
    for c in range(whole, size):
        i = pairs.first[c] if c < m else walls.disk[c - m]
        j = pairs.second[c] if c < m else -1
        apart, along = _motion(v, i, j, nx[c], nz[c], n, radius)
        rests = rests or (status[c] != 0.0 and normal[c] <= tip)
        if c < m:
            k = stiffness(pairs.law, overlap[c], take(pair_shape, c, 0.0))
            does, until, speed = _next(
                status[c], apart, along, overlap[c], normal[c], tangential[c], k, pairs.law, tip, negligible
            )
        else:
            k = stiffness(walls.law, overlap[c], take(walls.shape, c - m, 0.0))
            does, until, speed = _next(
                status[c], apart, along, overlap[c], normal[c], tangential[c], k, walls.law, tip, negligible
            )
        what[c], left[c], rate[c] = does, until, speed
    if rolls is not None:
        for c in range(size):
            i = pairs.first[c] if c < m else walls.disk[c - m]
            j = pairs.second[c] if c < m else -1
            if c < m:
                k = stiffness(pairs.law, overlap[c], take(pair_shape, c, 0.0))
            else:
                k = stiffness(walls.law, overlap[c], take(walls.shape, c - m, 0.0))
            apart, _ = _motion(v, i, j, nx[c], nz[c], n, radius)
            grows, falls = _rolling_rates(c, v, i, j, apart, k, n, rolls)
            does, until, speed, turned = 0.0, 0.0, 0.0, status[size + c]
            if turned != 0.0:
                limit = rolls.friction[c] * normal[c]
                does, until, speed = _next_to_limit(
                    does, until, speed, turned, limit, rolling[c], grows, falls, tip, negligible
                )
            what[size + c], left[size + c], rate[size + c] = does, until, speed
    if rests:
        count[:, :] = 0
        for i in range(n):
            count[0, i] = loaded[i]
        count_ties(pairs, walls, rolls, status, normal, tip, count)
        for c in range(size):
            if status[c] == 0.0 or normal[c] > tip:
                continue
            i = pairs.first[c] if c < m else walls.disk[c - m]
            j = pairs.second[c] if c < m else -1
            first = count[0, i] <= v.size // n and count[1, i] <= 1
            if not (first or (j >= 0 and count[0, j] <= v.size // n and count[1, j] <= 1)):
                continue
            does, speed = 0.0, 0.0
            if j >= 0:
                # the velocity of the rattler towards the other disk: one that would be drawn along stays behind
                drawn = -(v[i] * nx[c] + v[n + i] * nz[c]) if first else v[j] * nx[c] + v[n + j] * nz[c]
                if pairs.law.normal_stiffness * drawn > negligible:
                    does, speed = float(OPENS), pairs.law.normal_stiffness * drawn
            what[c], left[c], rate[c] = does, 0.0, speed
            if rolls is not None:
                what[size + c], left[size + c], rate[size + c] = 0.0, 0.0, 0.0
    due = 0
    for c in range(rate.size):
        due += rate[c] > 0.0 and left[c] <= tip
    return due


@kernel
def first_change(left, rate):
    """The contact that changes first, and after which growth of the load factor; 0 and infinity where none does."""
    first, length = 0, math.inf
    for c in range(rate.size):
        if rate[c] > 0.0 and max(left[c], 0.0) < length * rate[c]:
            first, length = c, max(left[c], 0.0) / rate[c]
    return first, length


@kernel
def changed_stiffness(
    contacts, before, after, q, n, radius, freedoms, pairs, walls, rolls, place, owner, places, left, right
):
    """Fill rows of ``places``, ``left`` and ``right`` (r, 6) with what other statuses of contacts add to the tangent.

    The tangent gains ``left[k]^T right[k]`` in the rows and columns ``places[k]``, for as many k as are returned: one
    where a contact changes between sticking, sliding and open along one direction, two where it opens from sticking.
    ``contacts`` (k,) : which, from m + w on along the rolling, and ``owner`` (r,) whose a row is; ``before``, ``after``
    : signed statuses of all; ``place`` (n,) : of disks in the order of the tangent.
    """
    size = pairs.first.size + walls.disk.size
    rows = 0
    for c in contacts:
        i, j, nx, nz, k, _, mu, kt = _contact_at(c % size, q, n, pairs, walls)
        # force along n and t on the first disk, of which the part along n changes with the overlap alone, and couple
        for part in range(3):
            if (part == 2) != (c >= size):
                continue
            # derivatives by the displacement along n, and by that along t or the rolling
            by_n, by_t = 0.0, 0.0
            for status, sign in ((after[c], 1.0), (before[c], -1.0)):
                sense = 1.0 if status > 0 else -1.0
                if status == OPEN:
                    continue
                if part == 0:
                    by_n -= sign * k
                elif part == 1 and abs(status) == SLIDING:
                    by_n -= sign * (mu * sense) * k
                elif part == 1 and mu > 0.0:
                    by_t -= sign * kt
                elif rolls is not None and part == 2:
                    arm = rolls.arm[c - size]
                    if abs(status) == SLIDING:
                        by_n -= sign * sense * arm * rolls.friction[c - size] * k
                    else:
                        by_t -= sign * arm * arm * rolls.stiffness[c - size]
            if by_n == 0.0 and by_t == 0.0:
                continue
            ex, ez = (nx, nz) if part == 0 else (-nz, nx)
            rx, rz = by_n * nx - by_t * nz, by_n * nz + by_t * nx
            for e in range(2):
                sign = 1.0 if e == 0 else -1.0
                live = 1.0 if e == 0 or j >= 0 else 0.0
                disk = i if e == 0 or j < 0 else j
                base = 3 * e
                for a in range(3):
                    places[rows, base + a] = place[disk] * freedoms + min(a, freedoms - 1)
                turns = live if freedoms == 3 else 0.0
                if part < 2:
                    couple = 0.0 if part == 0 else 1.0
                    left[rows, base] = -live * sign * ex
                    left[rows, base + 1] = -live * sign * ez
                    left[rows, base + 2] = turns * radius[disk] * couple
                    right[rows, base] = live * sign * rx
                    right[rows, base + 1] = live * sign * rz
                    right[rows, base + 2] = -turns * radius[disk] * by_t
                else:
                    left[rows, base], left[rows, base + 1], left[rows, base + 2] = 0.0, 0.0, -live * sign
                    right[rows, base] = live * sign * by_n * nx
                    right[rows, base + 1] = live * sign * by_n * nz
                    right[rows, base + 2] = live * sign * by_t
            owner[rows] = c
            rows += 1
    return rows
