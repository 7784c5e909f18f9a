"""Static contact forces by the return map, and their consistent tangent.

The quasi-static limit of the contact law over one increment: from a converged configuration (displacements
``q0``, springs ``spring0``) to a trial one ``q``, each tangential spring is stretched by the relative tangential
displacement of the increment and then cut to the Coulomb limit. The displacement is integrated over the
increment with the current normal (Delta s = mean distance times the turn of the normal minus the rolling part),
so there is no linearised geometry. A contact that closes within the increment collects slip only from where
it closed.

Vectors are laid out ``[x | z | angle]`` as everywhere in ``kernels``. For contact ``c`` the local tangent
``tangent[c]`` (3, 3) is the derivative of ``(f_x, f_z, f_t)`` on the first disk with respect to
``(w_x, w_z, rho)``, the relative displacement and ``R_i theta_i + R_j theta_j``.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..contact.coulomb import return_map
from ..contact.law import elastic_force, energy, stiffness
from ..machine.lanes import WIDTH, anywhere, gather, magnitude, put, quotient_where, root, select, spread, take
from ..machine.machine_code import kernel
from ..state import AT_LIMIT, OPEN, SLIDING, STICKING

Floats = NDArray[Any]

#: Tangent of an angle up to which five terms of its series are exact to rounding: the next one is 1e-18 of it.
SMALL_TURN = 0.02


class Pairs(NamedTuple):
    """(m,) listed contacts between disks at zero displacement."""

    first: NDArray[Any]
    second: NDArray[Any]
    dx: Floats  #: separation
    dz: Floats
    distance: Floats
    gap: Floats
    shape: Floats | None  #: what the law needs of the radii
    law: Any


class Walls(NamedTuple):
    """(w,) listed contacts of disks with walls at zero displacement."""

    disk: NDArray[Any]
    normal: Floats  #: (w, 2) inward
    gap: Floats
    shape: Floats | None
    law: Any


class Rolls(NamedTuple):
    """(m + w,) rolling resistance of listed contacts; of stiffness 0 where there is none."""

    arm: Floats  #: reduced radii
    friction: Floats
    stiffness: Floats


class Response(NamedTuple):
    """Contact forces at a trial configuration, to be filled."""

    overlap: Floats  #: (m,)
    normal: Floats
    tangential: Floats
    spring: Floats
    nx: Floats  #: direction of the normal force on the first body
    nz: Floats
    status: Floats  #: negative where it slides under a negative force

    @classmethod
    def empty(cls, size: int) -> Response:
        """Room for ``size`` contacts."""
        overlap, normal, tangential, spring, nx, nz, status = np.zeros((7, size))
        return cls(overlap, normal, tangential, spring, nx, nz, status)


class RollingResponse(NamedTuple):
    """Rolling resistance at a trial configuration, to be filled."""

    force: Floats  #: (m,)
    spring: Floats
    status: NDArray[Any]

    @classmethod
    def empty(cls, size: int) -> RollingResponse:
        """Room for ``size`` contacts."""
        force, spring = np.zeros((2, size))
        return cls(force, spring, np.zeros(size, np.int8))


@kernel
def _fill_tangent(g, nx, nz, normal, tangential, inverse, k, kt_w_t, kt_w_n, kt_rho, mu_slide):
    """Local tangent from the normal stiffness ``k`` and the derivative of the tangential force.

    ``d f_t = -(kt_w_t t.w + kt_w_n n.w - kt_rho rho)`` when sticking and ``mu_slide d f_n`` when sliding.
    """
    tx = -nz
    tz = nx
    # d f_n = -k n.w; d n = inverse (t.w) t; d t = -inverse (t.w) n
    ft_n = -kt_w_n - mu_slide * k
    ft_t = -kt_w_t
    for col in range(2):
        n_c = nx if col == 0 else nz
        t_c = tx if col == 0 else tz
        dfn = -k * n_c
        dft = ft_n * n_c + ft_t * t_c
        along_n = dfn - tangential * inverse * t_c
        along_t = dft + normal * inverse * t_c
        g[0, col] = along_n * nx + along_t * tx
        g[1, col] = along_n * nz + along_t * tz
        g[2, col] = dft
    g[0, 2] = kt_rho * tx
    g[1, 2] = kt_rho * tz
    g[2, 2] = kt_rho


@kernel(forceinline=True)
def _item(values, c):
    """The number of contact ``c``, or None where no contact has any."""
    if values is None:
        return None
    return values[c]


@kernel(forceinline=True)
def _pair_at(q, n, pairs, c):
    """Disks of a listed pair, their relative displacement, and separation, distance and overlap at ``q``."""
    i = pairs.first[c]
    j = pairs.second[c]
    ux = q[i] - q[j]
    uz = q[n + i] - q[n + j]
    dx0 = pairs.dx[c]
    dz0 = pairs.dz[c]
    dx = dx0 + ux
    dz = dz0 + uz
    d = math.sqrt(dx * dx + dz * dz)
    # |d| - |d0| without cancellation
    stretch = (2.0 * (dx0 * ux + dz0 * uz) + ux * ux + uz * uz) / (d + pairs.distance[c])
    return i, j, ux, uz, dx, dz, d, -(pairs.gap[c] + stretch)


@kernel(forceinline=True)
def _small_angle(sine, cosine):
    t = sine / cosine
    u = t * t
    return t - t * u * (1.0 / 3.0 - u * (1.0 / 5.0 - u * (1.0 / 7.0 - u * (1.0 / 9.0))))


@kernel(forceinline=True)
def _angle(sine, cosine):
    """``atan2(sine, cosine)``: of the small turn of an increment by its series, to the last digit."""
    if abs(sine) < SMALL_TURN * cosine:
        return _small_angle(sine, cosine)
    return math.atan2(sine, cosine)


@kernel(forceinline=True)
def _wall_at(q, n, walls, c):
    """Disk of a listed contact with a wall, the wall's normal, and the overlap at ``q``."""
    i = walls.disk[c]
    nx = walls.normal[c, 0]
    nz = walls.normal[c, 1]
    return i, nx, nz, -(walls.gap[c] + q[i] * nx + q[n + i] * nz)


@kernel(forceinline=True)
def _contact_at(c, q, n, pairs, walls):
    """Disks of contact ``c`` of all listed, pairs before walls, its normal at ``q``, and of the law there:

    normal stiffness, that at the weight of a disk, friction and tangential stiffness. A wall is the disk -1.
    """
    m = pairs.first.size
    if c < m:
        i, j, _, _, dx, dz, d, xi = _pair_at(q, n, pairs, c)
        law = pairs.law
        k = stiffness(law, xi, _item(pairs.shape, c))
        return i, j, dx / d, dz / d, k, law.normal_stiffness, law.friction, law.tangential_stiffness
    i, nx, nz, xi = _wall_at(q, n, walls, c - m)
    at_wall = walls.law
    k = stiffness(at_wall, xi, _item(walls.shape, c - m))
    return i, -1, nx, nz, k, at_wall.normal_stiffness, at_wall.friction, at_wall.tangential_stiffness


@kernel(forceinline=True)
def _closed_part(before, overlap):
    """Part of an increment from the overlap ``before`` in which a contact is closed."""
    return 1.0 if before >= 0.0 or overlap <= 0.0 else overlap / (overlap - before)


@kernel(forceinline=True)
def _returned(spring, limit, stiffness, kept):
    """Force, spring and sense of a contact, and by which force the return map would give another one.

    By the return map, or of the status ``kept``.
    """
    force, back, sense = return_map(spring, limit, stiffness)
    if kept is None:
        return force, back, sense, 0.0
    if abs(kept) == SLIDING:
        sense = 1.0 if kept > 0 else -1.0
        return sense * limit, -sense * limit / stiffness, sense, abs(sense * limit - force)
    return -stiffness * spring, spring, 0.0, abs(stiffness * spring + force)


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
def _closed(status, overlap):
    """Whether contacts are closed: by the ``status`` that they keep or, if that is None, by their overlap."""
    if status is None:
        return overlap > 0.0
    return magnitude(status) > 0.0


@kernel(forceinline=True)
def _most(limit, coulomb):
    """A limit of the tangential force that is given, or else that of Coulomb."""
    if limit is None:
        return coulomb
    return limit


@kernel(forceinline=True)
def _fill(c, like, status, overlap, before, slip, curved, limit, form, law, spring0, out, bend, worst):
    """Fill in contact ``c``, or those of a vector; normal and tangential force, and the largest bend and contradiction.

    ``status`` : kept, or None for the return map; ``limit`` : of Coulomb, or None; ``spring0`` : None without friction.
    """
    presses = overlap > 0.0
    closed = _closed(status, overlap)
    normal = select(closed, elastic_force(law, overlap, form), 0.0)
    now, wrong, tangential = select(closed, 1.0, 0.0 * overlap), 0.0 * overlap, 0.0 * overlap
    if status is not None:  # one that is kept open presses, or one that is kept closed pulls
        now, size = status + 0.0, elastic_force(law, magnitude(overlap), form)
        wrong = select(closed, select(overlap < 0.0, size, 0.0), select(presses, size, 0.0))
    if spring0 is not None:
        spring = take(spring0, c, like)
        stretched = spring + 0.0
        if status is not None:
            stretched = spring + select(magnitude(status) > STICKING, 0.0, magnitude(status)) * curved
            bent = magnitude(stretched - spring)
            bend = select(bent > bend, bent, bend)
        # one that closes collects slip from where it closed
        share = select(presses, quotient_where(before < 0.0, overlap, overlap - before, 1.0), 1.0)
        stretched = stretched + share * slip
        most = _most(limit, law.friction * normal)
        free = -law.tangential_stiffness * stretched
        within = magnitude(free) <= most
        tangential = select(closed, select(within, free, select(free > 0.0, most, -most)), 0.0)
        if status is None:
            now = select(closed, select(within, 1.0, select(free > 0.0, float(SLIDING), -float(SLIDING))), 0.0)
        else:
            kept = select(magnitude(status) > STICKING, select(status > 0.0, most, -most), free)
            kept = select(closed, kept, 0.0)
            off = magnitude(kept - tangential)
            wrong, tangential = select(off > wrong, off, wrong), kept
        put(out.tangential, c, tangential)
        new = quotient_where(magnitude(now) > STICKING, -tangential, law.tangential_stiffness, stretched)
        put(out.spring, c, select(closed, new, 0.0))
    put(out.overlap, c, overlap)
    put(out.normal, c, normal)
    put(out.status, c, now)
    return normal, tangential, bend, select(wrong > worst, wrong, worst)


@kernel
def _one_pair(
    c, q, q0, ahead, length, n, radius, pairs, pair_shape, overlap0, spring0, limits, fixed, out, bend, worst
):  # fmt: skip
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
        if fixed is not None:
            ax, az = length * (ahead[i] - ahead[j]), length * (ahead[n + i] - ahead[n + j])
            curved = _curved(px, pz, wx, wz, ax, az, 1.0 / pairs.distance[c])
    out.nx[c], out.nz[c] = dx / distance, dz / distance
    _, _, bend, worst = _fill(
        c, 0.0, take(fixed, c, 0.0), overlap, overlap0[c], slip, curved, take(limits, c, 0.0),
        take(pair_shape, c, 0.0), pairs.law, spring0, out, bend, worst,
    )  # fmt: skip
    return bend, worst


# Shapes are arguments of their own, beside the contacts that hold them: only of an argument does the compiler know
# that it is None.
@kernel
def contacts(
    q, q0, ahead, length, n, radius, pairs, pair_shape, walls, wall_shape, overlap0, pair_spring, wall_spring, limits,
    fixed, table, room, out, force,
):  # fmt: skip
    """Forces of m + w listed contacts at ``q``, one increment after ``q0``; pairs eight at once.

    Parameters
    ----------
    ahead, length : (dof,) and a number: their product is the displacement were the rates those at ``q0``. Where
        statuses are kept, the slip of pairs that stick along the way that curves from there is counted.
    pairs, walls : :class:`Pairs` and :class:`Walls`, and their ``shape``.
    overlap0 : (m + w,) at ``q0``.
    pair_spring, wall_spring : (m + w,) at ``q0``, None where the contacts have no friction.
    limits : (m + w,) fixed Coulomb limits, None for ``mu f_n``.
    fixed : (m + w,) statuses that contacts keep whatever happens, as floats, negative where they slide under a negative
        force, None for the return map.
    table, room : (m, 2) disks of the pairs, and (2 WIDTH,) numbers.
    out : :class:`Response`, filled.
    force : (dof,) generalised contact force, added to.

    Returns
    -------
    Longest part of a spring that a curved way has made, and the largest force by which contacts with kept statuses
    differ from those by the return map.
    """
    m = pairs.first.size
    like = spread(0.0)
    bends, wrongs = spread(0.0), spread(0.0)
    bend, worst = 0.0, 0.0
    for c in range(0, m, WIDTH):
        alone = c + WIDTH > m
        if not alone:
            ux = gather(q, 0, table, c, 0) - gather(q, 0, table, c, 1)
            uz = gather(q, n, table, c, 0) - gather(q, n, table, c, 1)
            wx = ux - (gather(q0, 0, table, c, 0) - gather(q0, 0, table, c, 1))
            wz = uz - (gather(q0, n, table, c, 0) - gather(q0, n, table, c, 1))
            distance0 = take(pairs.distance, c, like)
            dx, dz, distance, overlap, px, pz, before, sine, cosine = _pair(
                ux, uz, wx, wz, take(pairs.dx, c, like), take(pairs.dz, c, like), distance0, take(pairs.gap, c, like)
            )
            alone = pair_spring is not None and anywhere(magnitude(sine) >= SMALL_TURN * cosine)
        if alone:  # those of a far turn, and what is left of a vector
            for k in range(c, min(c + WIDTH, m)):
                bend, worst = _one_pair(
                    k, q, q0, ahead, length, n, radius, pairs, pair_shape, overlap0, pair_spring, limits, fixed, out,
                    bend, worst,
                )  # fmt: skip
            continue
        slip, curved = like, like
        if pair_spring is not None:
            ai, aj = gather(q, 2 * n, table, c, 0), gather(q, 2 * n, table, c, 1)
            ai, aj = ai - gather(q0, 2 * n, table, c, 0), aj - gather(q0, 2 * n, table, c, 1)
            roll = gather(radius, 0, table, c, 0) * ai + gather(radius, 0, table, c, 1) * aj
            slip = 0.5 * (before + distance) * _small_angle(sine, cosine) - roll
            if fixed is not None:
                ax = length * (gather(ahead, 0, table, c, 0) - gather(ahead, 0, table, c, 1))
                az = length * (gather(ahead, n, table, c, 0) - gather(ahead, n, table, c, 1))
                curved = _curved(px, pz, wx, wz, ax, az, 1.0 / distance0)
        put(out.nx, c, dx / distance)
        put(out.nz, c, dz / distance)
        _, _, bends, wrongs = _fill(
            c, like, take(fixed, c, like), overlap, take(overlap0, c, like), slip, curved, take(limits, c, like),
            take(pair_shape, c, like), pairs.law, pair_spring, out, bends, wrongs,
        )  # fmt: skip
    put(room, 0, bends)
    put(room, WIDTH, wrongs)
    for k in range(WIDTH):
        bend, worst = max(bend, room[k]), max(worst, room[WIDTH + k])
    for c in range(m):
        if out.status[c] == 0.0:
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
        out.nx[c], out.nz[c] = nx, nz
        normal, tangential, _, worst = _fill(
            c, 0.0, take(fixed, c, 0.0), overlap, overlap0[c], slip, 0.0, take(limits, c, 0.0),
            take(wall_shape, k, 0.0), walls.law, wall_spring, out, 0.0, worst,
        )  # fmt: skip
        force[i] += normal * nx - tangential * nz
        force[n + i] += normal * nz + tangential * nx
        if wall_spring is not None:
            force[2 * n + i] -= radius[i] * tangential
    return bend, worst


@kernel
def tangents(q, q0, n, pairs, walls, overlap0, limits, out, tangent):
    """Fill ``tangent`` (m + w, 3, 3) with those of contacts whose forces are ``out``, as :func:`contacts` made them."""
    for c in range(overlap0.size):
        status, xi = out.status[c], out.overlap[c]
        if status == 0.0:
            tangent[c, :, :] = 0.0
            continue
        i, j, nx, nz, k, _, mu, kt = _contact_at(c, q, n, pairs, walls)
        stiff, slip_n, slides, inverse = kt * _closed_part(overlap0[c], xi), 0.0, 0.0, 0.0
        mean, distance = 1.0, 1.0
        if j >= 0:
            _, _, ux, uz, dx, dz, distance, _ = _pair_at(q, n, pairs, c)
            wx, wz = ux - (q0[i] - q0[j]), uz - (q0[n + i] - q0[n + j])
            px, pz, inverse = dx - wx, dz - wz, 1.0 / distance
            mean = 0.5 * (math.sqrt(px * px + pz * pz) + distance)
            slip_n = 0.5 * _angle(px * wz - pz * wx, px * dx + pz * dz)
        if abs(status) > STICKING:
            stiff = 0.0
            slides = (mu if status > 0.0 else -mu) if limits is None else 0.0
        by_t = stiff * mean / distance
        _fill_tangent(
            tangent[c], nx, nz, out.normal[c], out.tangential[c], inverse, k, by_t, stiff * slip_n, stiff, slides
        )


@kernel
def rolling(q, q0, n, pairs, walls, rolls, known, overlap0, spring0, limits, fixed, out, tangent, force):
    """Rolling resistance of contacts of which :func:`contacts` has made the rest.

    ``rolls`` : :class:`Rolls`; ``known`` : the :class:`Response` there; ``spring0`` (m + w,) : as there, along the
    rolling; ``limits``, ``fixed`` : as there, those along the rolling behind; ``out`` : :class:`RollingResponse`,
    filled; ``tangent`` (m + w, 3), if not None : derivative of the couple on the first disk by relative displacement
    and rotation. Returns the largest force by which those with kept statuses differ from those by the return map.
    """
    size, worst = overlap0.size, 0.0
    for c in range(size):
        if known.status[c] == OPEN or rolls.stiffness[c] == 0.0:
            continue
        i, j, nx, nz, k, _, _, _ = _contact_at(c, q, n, pairs, walls)
        a, b = 2 * n + i, 2 * n + j
        turned = q[a] - q0[a]
        if j >= 0:
            turned -= q[b] - q0[b]
        arm = rolls.arm[c]
        share = _closed_part(overlap0[c], known.overlap[c])
        limit = rolls.friction[c] * known.normal[c] if limits is None else limits[size + c]
        kept = _item(fixed, size + c)
        found, new, sense, wrong = _returned(spring0[c] + share * arm * turned, limit, rolls.stiffness[c], kept)
        worst = max(worst, wrong)
        out.force[c], out.spring[c] = found, new
        out.status[c] = SLIDING if sense != 0.0 else STICKING
        force[a] += arm * found
        if j >= 0:
            force[b] -= arm * found
        if tangent is not None:
            slides = sense * rolls.friction[c] * k * arm if limits is None else 0.0
            tangent[c, 0] = -slides * nx
            tangent[c, 1] = -slides * nz
            tangent[c, 2] = 0.0 if sense != 0.0 else -arm * arm * rolls.stiffness[c] * share
    return worst


@kernel
def rolling_spring_forces(spring, status, normal, rolling, out):
    """Fill ``out`` (:class:`RollingResponse`) from springs (m,) as they are, where ``status`` (m,) is not OPEN."""
    for c in range(spring.size):
        if status[c] == OPEN:
            continue
        out.spring[c] = spring[c]
        out.force[c] = -rolling.stiffness * spring[c]
        within = abs(out.force[c]) < rolling.friction * abs(normal[c]) * (1 - AT_LIMIT)
        out.status[c] = STICKING if within else SLIDING


@kernel
def spring_forces(overlap, spring, shape, law, out):
    """Fill ``out`` (:class:`Response`) with forces from overlaps and springs (m,) as they are.

    A touching contact slides when its spring force has reached the Coulomb limit (to ``AT_LIMIT`` of it).
    """
    rubs = law.friction > 0.0
    for c in range(overlap.size):
        xi = overlap[c]
        out.overlap[c] = xi
        if not xi > 0.0:
            out.status[c] = OPEN
            continue
        fn = elastic_force(law, xi, _item(shape, c))
        out.normal[c] = fn
        out.status[c] = STICKING
        if rubs:
            out.spring[c] = spring[c]
            out.tangential[c] = -law.tangential_stiffness * spring[c]
            if abs(out.tangential[c]) >= law.friction * abs(fn) * (1 - AT_LIMIT):
                out.status[c] = SLIDING


def elastic_energy(overlap, shape, law) -> float:
    """Energy of the normal springs of contacts (m,)."""
    energies = np.zeros(len(overlap))
    _elastic_energies(overlap, shape, law, energies)
    return float(energies.sum())


@kernel
def _elastic_energies(overlap, shape, law, out):
    """Fill ``out`` (m,)."""
    for c in range(overlap.size):
        out[c] = energy(law, overlap[c], _item(shape, c)) if overlap[c] > 0.0 else 0.0


@kernel
def _add_block(data, base, stride, g, row_sign, row_arm, col_sign, col_arm, freedoms):
    """Add -L G Z to the block at ``data[base]``; L = diag(s, s, -R), Z = diag(s, s, R)."""
    for b in range(freedoms):
        zb = col_arm if b == 2 else col_sign
        for a in range(freedoms):
            la = -row_arm if a == 2 else row_sign
            data[base + b * stride + a] -= la * g[a, b] * zb


@kernel
def assemble(data, freedoms, first, second, radius, g, base, stride, wall_disk, wall_g, wall_base, wall_stride):
    """Sum local tangents into the values of a column-compressed matrix, ``K = -d F / d q``.

    Unknowns are interleaved, ``freedoms * place + component``. ``base`` : (m, 4) positions in ``data`` of the
    blocks (i, i), (i, j), (j, i), (j, j) (row, column); ``stride`` : (m, 4) distance between two columns of each.
    """
    data[:] = 0.0
    for c in range(first.size):
        ri = radius[first[c]]
        rj = radius[second[c]]
        _add_block(data, base[c, 0], stride[c, 0], g[c], 1.0, ri, 1.0, ri, freedoms)
        _add_block(data, base[c, 1], stride[c, 1], g[c], 1.0, ri, -1.0, rj, freedoms)
        _add_block(data, base[c, 2], stride[c, 2], g[c], -1.0, rj, 1.0, ri, freedoms)
        _add_block(data, base[c, 3], stride[c, 3], g[c], -1.0, rj, -1.0, rj, freedoms)
    for c in range(wall_disk.size):
        ri = radius[wall_disk[c]]
        _add_block(data, wall_base[c], wall_stride[c], wall_g[c], 1.0, ri, 1.0, ri, freedoms)


@kernel
def _add_couple_block(data, base, stride, g, sign):
    """Add what the couple of a contact adds to the row of a rotation in the block at ``data[base]``."""
    for b in range(3):
        data[base + b * stride + 2] -= sign * g[b]


@kernel
def assemble_rolling(data, g, base, stride, wall_g, wall_base, wall_stride):
    """Add rolling resistance to what :func:`assemble` has made; ``g`` (m, 3), ``wall_g`` (w, 3) : local tangents."""
    for c in range(g.shape[0]):
        for block in range(4):
            sign = 1.0 if block == 0 or block == 3 else -1.0
            _add_couple_block(data, base[c, block], stride[c, block], g[c], sign)
    for c in range(wall_g.shape[0]):
        _add_couple_block(data, wall_base[c], wall_stride[c], wall_g[c], 1.0)
