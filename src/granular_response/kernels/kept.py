"""Forces of contacts that keep their status, in vectors: between two events of a load path nothing else is asked for.

The numbers are those of :func:`.statics.contacts` with ``fixed`` statuses, to the last bit. Besides, the slip along
curved ways is counted, and by which force statuses contradict the return map.
"""

from __future__ import annotations

from ..contact.law import elastic_force
from ..machine.lanes import WIDTH, anywhere, gather, magnitude, put, quotient_where, root, select, spread, take
from ..machine.machine_code import kernel
from ..state.status import STICKING
from .statics import SMALL_TURN, _angle, _item, _shapes, _small_angle, _wall_at


@kernel(forceinline=True)
def _pair(ux, uz, wx, wz, dx0, dz0, distance0, gap):
    """Separation, distance and overlap of a pair, its separation and distance before, and sine and cosine of its turn.

    The latter are multiplied by both distances. ``ux``, ``uz`` : relative displacement; ``wx``, ``wz`` : its increment.
    """
    dx, dz = dx0 + ux, dz0 + uz
    distance = root(dx * dx + dz * dz)
    stretch = (2.0 * (dx0 * ux + dz0 * uz) + ux * ux + uz * uz) / (distance + distance0)
    px, pz = dx - wx, dz - wz
    before = root(px * px + pz * pz)
    return dx, dz, distance, -(gap + stretch), px, pz, before, px * wz - pz * wx, px * dx + pz * dz


@kernel(forceinline=True)
def _curved(px, pz, wx, wz, ax, az, part):
    """Slip of a pair along a curved way, less mean distance times turn.

    On its way a pair sets out as by a, its displacement were the rates those of the start, and the rest of its
    displacement grows as the square of the part done. With w the whole, p the separation and d its length, the integral
    of distance over angle exceeds mean distance times turn by
    (a x w) / 6 d - (p x a) ((p x a)^2 + 2 (p . a)^2) / 12 d^5, to third order in the displacement. ``part`` : 1 / d.
    """
    along_n = (px * ax + pz * az) * part
    along_t = (px * az - pz * ax) * part
    turned = along_t * (along_t * along_t + 2.0 * along_n * along_n)
    return (ax * wz - az * wx - 0.5 * turned * part) * part / 6.0


@kernel(forceinline=True)
def _kept(c, like, status, overlap, before, slip, curved, form, law, spring0, out, bend, worst):
    """Fill in contact ``c``, or those of a vector; normal and tangential force, and the largest bend and contradiction.

    ``spring0`` : None without friction.
    """
    closed, presses = magnitude(status) > 0.0, overlap > 0.0
    normal = select(closed, elastic_force(law, overlap, form), 0.0)
    # one that is kept open presses, or one that is kept closed pulls
    size = elastic_force(law, magnitude(overlap), form)
    wrong = select(closed, select(overlap < 0.0, size, 0.0), select(presses, size, 0.0))
    put(out.overlap, c, overlap)
    put(out.normal, c, normal)
    tangential = 0.0 * normal
    if spring0 is not None:
        spring = take(spring0, c, like)
        stretched = spring + select(magnitude(status) > STICKING, 0.0, magnitude(status)) * curved
        bent = magnitude(stretched - spring)
        bend = select(bent > bend, bent, bend)
        share = select(presses, quotient_where(before < 0.0, overlap, overlap - before, 1.0), 1.0)
        stretched = stretched + share * slip
        slides, free, limit = magnitude(status) > STICKING, -law.tangential_stiffness * stretched, law.friction * normal
        returned = select(magnitude(free) <= limit, free, select(free > 0.0, limit, -limit))
        tangential = select(closed, select(slides, select(status > 0.0, limit, -limit), free), 0.0)
        off = select(closed, magnitude(tangential - returned), 0.0)
        wrong = select(off > wrong, off, wrong)
        put(out.tangential, c, tangential)
        new = quotient_where(slides, -tangential, law.tangential_stiffness, stretched)
        put(out.spring, c, select(closed, new, 0.0))
    return normal, tangential, bend, select(wrong > worst, wrong, worst)


@kernel(forceinline=True)
def _one_pair(c, q, q0, ahead, length, n, radius, pairs, pair_shape, overlap0, spring0, fixed, out, bend, worst):
    """Fill in one pair."""
    i, j = pairs.first[c], pairs.second[c]
    ux, uz = q[i] - q[j], q[n + i] - q[n + j]
    wx, wz = ux - (q0[i] - q0[j]), uz - (q0[n + i] - q0[n + j])
    dx, dz, distance, overlap, px, pz, before, sine, cosine = _pair(
        ux, uz, wx, wz, pairs.dx[c], pairs.dz[c], pairs.distance[c], pairs.gap[c]
    )
    slip, curved = 0.0, 0.0
    if spring0 is not None:
        roll = radius[i] * (q[2 * n + i] - q0[2 * n + i]) + radius[j] * (q[2 * n + j] - q0[2 * n + j])
        slip = 0.5 * (before + distance) * _angle(sine, cosine) - roll
        ax, az = length * (ahead[i] - ahead[j]), length * (ahead[n + i] - ahead[n + j])
        curved = _curved(px, pz, wx, wz, ax, az, 1.0 / pairs.distance[c])
    out.nx[c], out.nz[c] = dx / distance, dz / distance
    _, _, bend, worst = _kept(
        c, 0.0, fixed[c], overlap, overlap0[c], slip, curved, _item(pair_shape, c), pairs.law, spring0, out, bend, worst
    )
    return bend, worst


@kernel
def kept_contacts(
    q, q0, ahead, length, n, radius, pairs, pair_shape, walls, wall_shape, overlap0, pair_spring, wall_spring, fixed,
    table, room, out, force,
):  # fmt: skip
    """Add to ``force`` (dof,) and fill ``out`` with the forces of contacts that keep the statuses ``fixed`` (m + w,).

    As of :func:`.statics.contacts`, but for: ``ahead`` (dof,), ``length`` : their product is the displacement were the
    rates those at ``q0``, for the slip of pairs that stick along a way that curves from there; ``fixed`` : of floats;
    ``table`` (m, 2) : disks of the pairs; ``room`` (2, WIDTH).

    Returns
    -------
    Longest part of a spring that a curved way has made, and the largest force by which contacts differ from those by
    the return map.
    """
    m = pairs.first.size
    like = spread(0.0)
    bends, wrongs = spread(0.0), spread(0.0)
    bend, worst = 0.0, 0.0
    whole = m - m % WIDTH
    for c in range(0, whole, WIDTH):
        ux = gather(q, 0, table, c, 0) - gather(q, 0, table, c, 1)
        uz = gather(q, n, table, c, 0) - gather(q, n, table, c, 1)
        wx = ux - (gather(q0, 0, table, c, 0) - gather(q0, 0, table, c, 1))
        wz = uz - (gather(q0, n, table, c, 0) - gather(q0, n, table, c, 1))
        dx, dz, distance, overlap, px, pz, before, sine, cosine = _pair(
            ux, uz, wx, wz, take(pairs.dx, c, like), take(pairs.dz, c, like), take(pairs.distance, c, like),
            take(pairs.gap, c, like),
        )  # fmt: skip
        slip, curved = like, like
        if pair_spring is not None:
            if anywhere(magnitude(sine) >= SMALL_TURN * cosine):  # far turns are for one pair at a time
                for k in range(c, c + WIDTH):
                    bend, worst = _one_pair(
                        k, q, q0, ahead, length, n, radius, pairs, pair_shape, overlap0, pair_spring, fixed, out, bend,
                        worst,
                    )  # fmt: skip
                continue
            ai, aj = gather(q, 2 * n, table, c, 0), gather(q, 2 * n, table, c, 1)
            ai, aj = ai - gather(q0, 2 * n, table, c, 0), aj - gather(q0, 2 * n, table, c, 1)
            roll = gather(radius, 0, table, c, 0) * ai + gather(radius, 0, table, c, 1) * aj
            slip = 0.5 * (before + distance) * _small_angle(sine, cosine) - roll
            ax = length * (gather(ahead, 0, table, c, 0) - gather(ahead, 0, table, c, 1))
            az = length * (gather(ahead, n, table, c, 0) - gather(ahead, n, table, c, 1))
            curved = _curved(px, pz, wx, wz, ax, az, 1.0 / take(pairs.distance, c, like))
        put(out.nx, c, dx / distance)
        put(out.nz, c, dz / distance)
        _, _, bends, wrongs = _kept(
            c, like, take(fixed, c, like), overlap, take(overlap0, c, like), slip, curved,
            _shapes(pair_shape, c, like), pairs.law, pair_spring, out, bends, wrongs,
        )  # fmt: skip
    for c in range(whole, m):
        bend, worst = _one_pair(
            c, q, q0, ahead, length, n, radius, pairs, pair_shape, overlap0, pair_spring, fixed, out, bend, worst
        )
    put(room, 0, bends)
    put(room, WIDTH, wrongs)
    for k in range(WIDTH):
        bend, worst = max(bend, room[k]), max(worst, room[WIDTH + k])
    for c in range(m):
        if fixed[c] == 0.0:
            continue
        i, j = pairs.first[c], pairs.second[c]
        normal, nx, nz = out.normal[c], out.nx[c], out.nz[c]
        fx, fz = normal * nx, normal * nz
        if pair_spring is not None:
            tangential = out.tangential[c]
            fx, fz = fx - tangential * nz, fz + tangential * nx
            force[2 * n + i] -= radius[i] * tangential
            force[2 * n + j] -= radius[j] * tangential
        force[i] += fx
        force[n + i] += fz
        force[j] -= fx
        force[n + j] -= fz
    for k in range(walls.disk.size):
        i, nx, nz, overlap = _wall_at(q, n, walls, k)
        c = m + k
        slip = 0.0
        if wall_spring is not None:
            slip = (q[n + i] - q0[n + i]) * nx - (q[i] - q0[i]) * nz
            slip -= radius[i] * (q[2 * n + i] - q0[2 * n + i])
        normal, tangential, _, worst = _kept(
            c, 0.0, fixed[c], overlap, overlap0[c], slip, 0.0, _item(wall_shape, k), walls.law, wall_spring, out, 0.0,
            worst,
        )  # fmt: skip
        out.nx[c], out.nz[c] = nx, nz
        force[i] += normal * nx - tangential * nz
        force[n + i] += normal * nz + tangential * nx
        if wall_spring is not None:
            force[2 * n + i] -= radius[i] * tangential
    return bend, worst
