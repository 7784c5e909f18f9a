"""What each contact does next on a quasi-static path, from the rates of all displacements.

While every contact keeps its status, displacements are smooth in the load. A contact changes where its overlap or what
is left to Coulomb's limit has fallen to zero; one that slides sticks as soon as its slip would turn round.
"""

from __future__ import annotations

import math

from ..machine.machine_code import kernel
from ..state.status import OPEN, SLIDING, STICKING
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
    """What a contact does next, if it opens so, or does nothing, unless friction makes it do something before.

    ``limit`` : of a ``force`` that grows, if it sticks, while the limit falls.
    """
    if abs(status) == SLIDING:
        sense = 1.0 if status > 0 else -1.0
        behind = -(sense * grows + falls)
        if behind > negligible:
            return STICKS, 0.0, behind
        return what, left, rate
    for sense in (1.0, -1.0):
        closing = sense * grows + falls
        if closing > negligible:
            room = limit - sense * force
            # one that bears nothing slides before it opens
            first = room <= tip and left <= tip and closing > rate
            if rate == 0.0 or room * rate < left * closing or first:
                what, left, rate = SLIDES if sense > 0.0 else -SLIDES, room, closing
    return what, left, rate


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
def _count(pairs, walls, rolls, status, normal, tip, ties, bearing, turning):
    """Count what ties each disk, (n,), along normals and where contacts stick, and its contacts that bear something.

    ``turning`` counts those that stick: where there is none its turn changes no force.
    """
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


@kernel
def next_changes(
    q, v, n, radius, pairs, walls, rolls, normal, tangential, rolling, overlap, status, tip, negligible, count, what,
    left, rate,
):  # fmt: skip
    """Fill ``what``, ``left`` (mean weights) and ``rate`` (of the fall of ``left``), as long as ``status`` each.

    ``q``, ``v`` (dof,) : displacements and their rates; ``rolls`` : ``statics.Rolls`` or None; ``normal``,
    ``tangential``, ``rolling``, ``overlap`` (m + w,) : forces, the rolling ones None without; ``status`` (m + w,), or
    twice as many with rolling resistance : negative for contacts that slide under a negative force; ``tip``,
    ``negligible`` : a force and a rate of a force that are none; ``count`` (3, n) : to count contacts in, from zero, or
    from more ties than freedoms where a load acts; in the last row those that stick. A rattler that
    rests on one contact and that no more ties than it has freedoms, pushed along by another disk, bears nothing there
    however it moves: such a contact opens when the other disk withdraws, and nothing else happens to it.
    """
    ties, bearing = count[0], count[1]
    _count(pairs, walls, rolls, status, normal, tip, ties, bearing, count[2])
    freedoms = q.size // n
    size = normal.size
    for c in range(size):
        i, j, nx, nz, k, unit, mu, kt = _contact_at(c, q, n, pairs, walls)
        does, until, speed = NOTHING, 0.0, 0.0
        does_roll, until_roll, speed_roll = NOTHING, 0.0, 0.0
        apart, along = _motion(v, i, j, nx, nz, n, radius)
        first = ties[i] <= freedoms and bearing[i] <= 1
        second = j >= 0 and ties[j] <= freedoms and bearing[j] <= 1
        if status[c] == OPEN:
            if -unit * apart > negligible:
                does, until, speed = CLOSES, -unit * overlap[c], -unit * apart
        elif normal[c] <= tip and (first or second):
            if j >= 0:
                # the velocity of the rattler towards the other disk: one that would be drawn along stays behind
                drawn = -(v[i] * nx + v[n + i] * nz) if first else v[j] * nx + v[n + j] * nz
                if unit * drawn > negligible:
                    does, speed = OPENS, unit * drawn
        else:
            if unit * apart > negligible:
                does, until, speed = OPENS, unit * overlap[c], unit * apart
            if mu > 0.0:
                does, until, speed = _next_to_limit(
                    does, until, speed, status[c], mu * normal[c], tangential[c], -kt * along, mu * k * apart, tip,
                    negligible,
                )  # fmt: skip
            if rolls is not None and status[size + c] != OPEN:
                grows, falls = _rolling_rates(c, v, i, j, apart, k, n, rolls)
                does_roll, until_roll, speed_roll = _next_to_limit(
                    NOTHING, 0.0, 0.0, status[size + c], rolls.friction[c] * normal[c], rolling[c], grows, falls, tip,
                    negligible,
                )  # fmt: skip
        what[c], left[c], rate[c] = does, until, speed
        if rolls is not None:
            what[size + c], left[size + c], rate[size + c] = does_roll, until_roll, speed_roll


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
