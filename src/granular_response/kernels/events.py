"""What each contact does next on a quasi-static path, from the rates of all displacements.

While every contact keeps its status, displacements are smooth in the load. A contact changes where its overlap or what
is left to Coulomb's limit has fallen to zero; one that slides sticks as soon as its slip would turn round.
"""

from __future__ import annotations

import math

from ..contact.law import stiffness
from ..machine.machine_code import kernel
from ..state.status import OPEN, SLIDING
from .statics import _pair_at, _shape_at, _wall_at

#: What a contact does next; ``SLIDES`` is negative where it will slide under a negative force.
NOTHING, OPENS, CLOSES, SLIDES, STICKS = 0, 1, 2, 3, 4


@kernel(forceinline=True)
def _next(status, overlap, normal, tangential, apart, along, k, law, tip, negligible):
    """What a contact does next, which force is left until then, and the rate at which that falls.

    ``apart``, ``along`` : rates of the relative displacement along the normal and, less the rolling, along the tangent;
    ``k`` : normal stiffness; ``tip`` : force that is none; ``negligible`` : rate of a force that is none.
    """
    unit = law.normal_stiffness
    if status == OPEN:
        if -unit * apart > negligible:
            return CLOSES, -unit * overlap, -unit * apart
        return NOTHING, 0.0, 0.0
    what, left, rate = NOTHING, 0.0, 0.0
    if unit * apart > negligible:
        what, left, rate = OPENS, unit * overlap, unit * apart
    mu = law.friction
    if mu > 0.0:
        limit_falls = mu * k * apart
        grows = -law.tangential_stiffness * along  # if it sticks
        if abs(status) == SLIDING:
            sense = 1.0 if status > 0 else -1.0
            behind = -(sense * grows + limit_falls)
            if behind > negligible:
                return STICKS, 0.0, behind
        else:
            for sense in (1.0, -1.0):
                closing = sense * grows + limit_falls
                if closing > negligible:
                    room = mu * normal - sense * tangential
                    # one that bears nothing slides before it opens
                    first = room <= tip and left <= tip and closing > rate
                    if rate == 0.0 or room * rate < left * closing or first:
                        what, left, rate = SLIDES if sense > 0.0 else -SLIDES, room, closing
    return what, left, rate


@kernel(forceinline=True)
def _fall(what, apart, along, k, law):
    """By how much a displacement ``apart``, ``along`` lowers the force that is left until a contact does ``what``."""
    if what == OPENS:
        return law.normal_stiffness * apart
    if what == CLOSES:
        return -law.normal_stiffness * apart
    sense = 1.0 if what > 0 else -1.0
    return law.friction * k * apart - sense * law.tangential_stiffness * along


@kernel
def fall(c, what, q, v, n, radius, pairs, walls):
    """By how much displacements ``v`` (dof,) lower the force that is left until contact ``c`` does ``what``."""
    m = pairs.first.size
    turn = q.size == 3 * n
    if c < m:
        i, j, _, _, dx, dz, d, xi = _pair_at(q, n, pairs, c)
        nx, nz = dx / d, dz / d
        wx, wz = v[i] - v[j], v[n + i] - v[n + j]
        along = wz * nx - wx * nz
        if turn:
            along -= radius[i] * v[2 * n + i] + radius[j] * v[2 * n + j]
        return _fall(what, wx * nx + wz * nz, along, stiffness(pairs.law, xi, _shape_at(pairs.shape, c)), pairs.law)
    i, nx, nz, xi = _wall_at(q, n, walls, c - m)
    along = v[n + i] * nx - v[i] * nz
    if turn:
        along -= radius[i] * v[2 * n + i]
    k = stiffness(walls.law, xi, _shape_at(walls.shape, c - m))
    return _fall(what, v[i] * nx + v[n + i] * nz, along, k, walls.law)


@kernel
def _count(pairs, walls, status, normal, tip, ties, bearing):
    """Count what ties each disk, (n,), along normals and where contacts stick, and the contacts that bear something."""
    m = pairs.first.size
    for c in range(m + walls.disk.size):
        if status[c] == OPEN:
            continue
        mu = pairs.law.friction if c < m else walls.law.friction
        tied = 2 if mu > 0.0 and abs(status[c]) != SLIDING else 1
        bears = normal[c] > tip
        i = pairs.first[c] if c < m else walls.disk[c - m]
        ties[i] += tied
        bearing[i] += bears
        if c < m:
            ties[pairs.second[c]] += tied
            bearing[pairs.second[c]] += bears


@kernel
def next_changes(
    q, v, n, radius, pairs, walls, status, normal, tangential, overlap, tip, negligible, count, what, left, rate
):
    """Fill ``what``, ``left`` (mean weights) and ``rate`` (of the fall of ``left``), (m + w,) each.

    ``q``, ``v`` (dof,) : displacements and their rates; ``status`` (m + w,) : negative for contacts that slide under a
    negative force; ``normal``, ``tangential``, ``overlap`` (m + w,); ``tip``, ``negligible`` : a force and a rate of a
    force that are none; ``count`` (2, n) : to count contacts in, from zero, or from more ties than freedoms where a
    load acts. A rattler that rests on one contact and that no more ties than it has freedoms, pushed along by another
    disk, bears nothing there however it moves: such a contact opens when the other disk withdraws, and nothing else
    happens to it.
    """
    m = pairs.first.size
    turn = q.size == 3 * n
    ties, bearing = count[0], count[1]
    _count(pairs, walls, status, normal, tip, ties, bearing)
    freedoms = q.size // n
    for c in range(m):
        i, j, _, _, dx, dz, d, xi = _pair_at(q, n, pairs, c)
        if status[c] != OPEN and normal[c] <= tip:
            first = ties[i] <= freedoms and bearing[i] <= 1
            if first or (ties[j] <= freedoms and bearing[j] <= 1):
                # the velocity of the rattler towards the other disk: one that would be drawn along stays behind
                drawn = (v[j] * dx + v[n + j] * dz) / d if not first else -(v[i] * dx + v[n + i] * dz) / d
                drawn *= pairs.law.normal_stiffness
                what[c], left[c], rate[c] = (OPENS, 0.0, drawn) if drawn > negligible else (NOTHING, 0.0, 0.0)
                continue
        nx, nz = dx / d, dz / d
        wx, wz = v[i] - v[j], v[n + i] - v[n + j]
        along = wz * nx - wx * nz
        if turn:
            along -= radius[i] * v[2 * n + i] + radius[j] * v[2 * n + j]
        k = stiffness(pairs.law, xi, _shape_at(pairs.shape, c))
        what[c], left[c], rate[c] = _next(
            status[c], overlap[c], normal[c], tangential[c], wx * nx + wz * nz, along, k, pairs.law, tip, negligible
        )
    for c in range(walls.disk.size):
        i, nx, nz, xi = _wall_at(q, n, walls, c)
        w = m + c
        if status[w] != OPEN and normal[w] <= tip and ties[i] <= freedoms and bearing[i] <= 1:
            what[w], left[w], rate[w] = NOTHING, 0.0, 0.0
            continue
        along = v[n + i] * nx - v[i] * nz
        if turn:
            along -= radius[i] * v[2 * n + i]
        k = stiffness(walls.law, xi, _shape_at(walls.shape, c))
        what[w], left[w], rate[w] = _next(
            status[w], overlap[w], normal[w], tangential[w], v[i] * nx + v[n + i] * nz, along, k, walls.law, tip,
            negligible,
        )  # fmt: skip


@kernel
def first_change(left, rate):
    """The contact that changes first, and after which growth of the load factor; 0 and infinity where none does."""
    first, length = 0, math.inf
    for c in range(rate.size):
        if rate[c] > 0.0 and max(left[c], 0.0) < length * rate[c]:
            first, length = c, max(left[c], 0.0) / rate[c]
    return first, length


@kernel
def changed_stiffness(c, before, after, q, n, radius, freedoms, pairs, walls, place, places, left, right):
    """Fill ``places``, ``left`` and ``right`` (2, 6) with what another status of contact ``c`` adds to the tangent.

    The tangent gains ``left[k]^T right[k]`` in the rows and columns ``places[k]``, for as many k as are returned: one
    where the contact changes between sticking, sliding and open along one direction, two where it opens from sticking.
    ``before``, ``after`` : signed statuses; ``place`` (n,) : of disks in the order of the tangent.
    """
    m = pairs.first.size
    if c < m:
        i, j, _, _, dx, dz, d, xi = _pair_at(q, n, pairs, c)
        nx, nz = dx / d, dz / d
        k = stiffness(pairs.law, xi, _shape_at(pairs.shape, c))
        mu, kt = pairs.law.friction, pairs.law.tangential_stiffness
        disks = 2
    else:
        i, nx, nz, xi = _wall_at(q, n, walls, c - m)
        j = i
        k = stiffness(walls.law, xi, _shape_at(walls.shape, c - m))
        mu, kt = walls.law.friction, walls.law.tangential_stiffness
        disks = 1
    rows = 0
    # force along n and t on the first disk: the part along n changes with the overlap alone
    for part in range(2):
        # derivatives of the force along n (part 0) or t (part 1) by the displacement along n and along t
        by_n, by_t = 0.0, 0.0
        for status, sign in ((after, 1.0), (before, -1.0)):
            if status == OPEN:
                continue
            if part == 0:
                by_n -= sign * k
            elif abs(status) == SLIDING:
                by_n -= sign * (mu if status > 0 else -mu) * k
            elif mu > 0.0:
                by_t -= sign * kt
        if by_n == 0.0 and by_t == 0.0:
            continue
        ex, ez = (nx, nz) if part == 0 else (-nz, nx)
        couple = 0.0 if part == 0 else 1.0
        rx, rz = by_n * nx - by_t * nz, by_n * nz + by_t * nx
        for e in range(2):
            sign = 1.0 if e == 0 else -1.0
            disk = i if e == 0 else j
            live = 1.0 if e < disks else 0.0
            base = 3 * e
            for a in range(3):
                places[rows, base + a] = place[disk] * freedoms + min(a, freedoms - 1)
            turns = live if freedoms == 3 else 0.0
            left[rows, base] = -live * sign * ex
            left[rows, base + 1] = -live * sign * ez
            left[rows, base + 2] = turns * radius[disk] * couple
            right[rows, base] = live * sign * rx
            right[rows, base + 1] = live * sign * rz
            right[rows, base + 2] = -turns * radius[disk] * by_t
        rows += 1
    return rows
