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
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..contact.coulomb import cut, limit, limit_slope
from ..contact.geometry import at_wall, displaced
from ..contact.law import elastic_force, energy, stiffness
from ..contact.rolling import FREE
from ..machine.lanes import WIDTH, anywhere, gather, magnitude, put, quotient_where, root, select, spread, take
from ..machine.machine_code import kernel
from ..state import AT_LIMIT, OPEN, SLIDING, STICKING

Floats = NDArray[Any]

#: Tangent of an angle up to which five terms of its series are exact to rounding: the next one is 1e-18 of it.
SMALL_TURN = 0.02


class Listed(NamedTuple):
    """m + w candidate contacts at zero displacement: m of two disks, then w of a disk with a wall."""

    disks: NDArray[Any]  #: (m + w, 2) int64, disks of each; the second of a wall is -1
    pairs: int  #: m
    dx: Floats  #: (m + w,) separations; at walls the inward normal
    dz: Floats
    distance: Floats  #: (m + w,); 1 at walls
    gap: Floats  #: (m + w,)
    shape: Floats | None  #: (m + w,) what the law needs of the radii
    pair_law: Any  #: named tuples of ``contact``, of one class
    wall_law: Any
    pair_rolling: Any  #: contact.rolling.Rolling, of zeros for contacts that do not resist
    wall_rolling: Any
    arm: Floats  #: (m + w,) reduced radii, or (0,) where no contact resists rolling
    radius: Floats  #: (n,) of all disks
    loaded: NDArray[Any]  #: (n,) ties that loads count as


def of_rows(laws) -> dict[str, Any]:
    """The laws of :class:`Listed` from those between disks and at walls in each row (``state.ROWS``) that there is."""
    names = "pair_law", "wall_law", "pair_rolling", "wall_rolling"
    return dict(zip(names, chain(*laws, (FREE, FREE)), strict=False))


class Increment(NamedTuple):
    """From a configuration that is known to a trial. Springs, limits and statuses follow each other row by row.

    Attributes
    ----------
    ahead, length : (dof,) and a number: their product is the displacement were the rates those at ``q0``. Where
        statuses are kept, the slip of pairs that stick along the way that curves from there is counted.
    limits : (r (m + w),) fixed limits, or (0,) for those of the law.
    fixed : (r (m + w),) statuses that contacts keep whatever happens, as floats, negative where they slide under a
        negative force, or (0,) for the return map.
    """

    q: Floats  #: (dof,) displacements
    q0: Floats  #: (dof,) those that are known
    ahead: Floats
    length: float
    overlap: Floats  #: (m + w,) at ``q0``
    spring: Floats  #: (r (m + w),) at ``q0``
    limits: Floats
    fixed: Floats


class Response(NamedTuple):
    """Contact forces at a trial configuration, to be filled; tangential ones and all after them row by row."""

    overlap: Floats  #: (m + w,)
    normal: Floats  #: (m + w,)
    nx: Floats  #: (m + w,) direction of the normal force on the first body
    nz: Floats
    tangential: Floats  #: (r (m + w),)
    spring: Floats
    status: Floats  #: negative where it slides under a negative force


@kernel(forceinline=True)
def law_of(listed, c):
    """The law of contact ``c``."""
    return listed.pair_law if c < listed.pairs else listed.wall_law


@kernel(forceinline=True)
def resistance(c, normal, listed):
    """Stiffness, limit and slope of the limit in place ``c`` of the rows, of a contact with a ``normal`` force."""
    size = listed.gap.size
    if c < size:
        law = law_of(listed, c)
        return law.tangential_stiffness, limit(law, normal), limit_slope(law, normal)
    rolling = listed.pair_rolling if c - size < listed.pairs else listed.wall_rolling
    return rolling.tangential_stiffness, limit(rolling, normal), limit_slope(rolling, normal)


@kernel(forceinline=True)
def lever(c, i, j, nx, nz, listed):
    """What a unit force in place ``c`` of the rows does: force on disk ``i``, couples on ``i`` and ``j``, and the arm.

    Couples along the rolling are to be multiplied with the arm, and so is the slip against which the force acts.
    """
    size = listed.gap.size
    if c < size:
        return -nz, nx, -listed.radius[i], -listed.radius[j] if j >= 0 else 0.0, 1.0
    return 0.0, 0.0, 1.0, -1.0 if j >= 0 else 0.0, listed.arm[c - size]


@kernel(forceinline=True)
def contact_at(c, q, listed):
    """Disks of contact ``c``, its normal, overlap and normal stiffness at ``q``. A wall is the disk -1."""
    n, i, j = listed.radius.size, listed.disks[c, 0], listed.disks[c, 1]
    nx, nz, gap = listed.dx[c], listed.dz[c], listed.gap[c]
    if j < 0:
        overlap = at_wall(q[i], q[n + i], nx, nz, gap)
    else:
        dx, dz, distance, overlap = displaced(q[i] - q[j], q[n + i] - q[n + j], nx, nz, listed.distance[c], gap)
        nx, nz = dx / distance, dz / distance
    return i, j, nx, nz, overlap, stiffness(law_of(listed, c), overlap, take(listed.shape, c, 0.0))


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
def _angles(sine, cosine, room):
    """The same of lanes too."""
    if not anywhere(magnitude(sine) >= SMALL_TURN * cosine):
        return _small_angle(sine, cosine)
    put(room, 0, sine)
    put(room, WIDTH, cosine)
    for k in range(WIDTH):
        room[k] = _angle(room[k], room[WIDTH + k])
    return take(room, 0, sine)


@kernel(forceinline=True)
def _closed_part(before, overlap):
    """Part of an increment from the overlap ``before`` in which a contact is closed."""
    return 1.0 if before >= 0.0 or overlap <= 0.0 else overlap / (overlap - before)


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
def _turned(dx, dz, wx, wz):
    """Separation and distance of a pair before an increment ``(wx, wz)``, and sine and cosine of its turn.

    The latter are multiplied by both distances.
    """
    px, pz = dx - wx, dz - wz
    return px, pz, root(px * px + pz * pz), px * wz - pz * wx, px * dx + pz * dz


@kernel(forceinline=True)
def _given(values, c, otherwise):
    """What is given of place ``c`` of the rows, or else ``otherwise``."""
    return take(values, c, otherwise) if values.size else otherwise


@kernel(forceinline=True)
def _returned(trial, most, stiffness, c, fixed):
    """Force, new spring, signed status, and contradiction, of closed contacts with a spring stretched to ``trial``.

    By the return map, or of the status that place ``c`` of the rows keeps: the contradiction is the force by which both
    differ.
    """
    force, spring, slides = cut(trial, 0.0, most, stiffness)
    if fixed.size == 0:
        return force, spring, select(slides, select(trial < 0.0, float(SLIDING), -float(SLIDING)), 1.0), 0.0 * force
    status = take(fixed, c, trial)
    slides = magnitude(status) > STICKING
    kept = select(slides, select(status > 0.0, most, -most), -stiffness * trial)
    return kept, quotient_where(slides, -kept, stiffness, trial), status, magnitude(kept - force)


@kernel(forceinline=True)
def _fill(c, overlap, slip, curved, law, spring0, step, listed, out):
    """Fill in contact ``c``, or those of a vector.

    ``spring0`` : of ``step``, None without friction. Returns the parts of their springs that curved ways made, and
    contradictions.
    """
    form, presses = take(listed.shape, c, overlap), overlap > 0.0
    now, bent, wrong = select(presses, 1.0, 0.0 * overlap), 0.0 * overlap, 0.0 * overlap
    if step.fixed.size:  # one that is kept open presses, or one that is kept closed pulls
        now, size = take(step.fixed, c, overlap), elastic_force(law, magnitude(overlap), form)
        wrong = select(magnitude(now) > 0.0, select(overlap < 0.0, size, 0.0), select(presses, size, 0.0))
    closed = magnitude(now) > 0.0
    normal = select(closed, elastic_force(law, overlap, form), 0.0)
    if spring0 is not None:
        spring = take(spring0, c, overlap)
        trial = spring + 0.0
        if step.fixed.size:
            trial = spring + select(magnitude(now) > STICKING, 0.0, magnitude(now)) * curved
            bent = magnitude(trial - spring)
        # one that closes collects slip from where it closed
        before = take(step.overlap, c, overlap)
        share = select(presses, quotient_where(before < 0.0, overlap, overlap - before, 1.0), 1.0)
        most = _given(step.limits, c, limit(law, normal))
        force, spring, sense, off = _returned(trial + share * slip, most, law.tangential_stiffness, c, step.fixed)
        off = select(closed, off, 0.0)
        now, wrong = select(closed, sense, 0.0), select(off > wrong, off, wrong)
        put(out.tangential, c, select(closed, force, 0.0))
        put(out.spring, c, select(closed, spring, 0.0))
    put(out.overlap, c, overlap)
    put(out.normal, c, normal)
    put(out.status, c, now)
    return bent, wrong


@kernel(forceinline=True)
def fill_pair(c, like, spring0, step, listed, room, out):
    """Fill in pair ``c``, or as many from there on as ``like`` has lanes; the rest as of :func:`_fill`."""
    n, disks, radius = listed.radius.size, listed.disks, listed.radius
    q, q0, ahead, length = step.q, step.q0, step.ahead, step.length
    ux = gather(q, 0, disks, c, 0, like) - gather(q, 0, disks, c, 1, like)
    uz = gather(q, n, disks, c, 0, like) - gather(q, n, disks, c, 1, like)
    wx = ux - (gather(q0, 0, disks, c, 0, like) - gather(q0, 0, disks, c, 1, like))
    wz = uz - (gather(q0, n, disks, c, 0, like) - gather(q0, n, disks, c, 1, like))
    distance0, gap = take(listed.distance, c, like), take(listed.gap, c, like)
    dx, dz, distance, overlap = displaced(ux, uz, take(listed.dx, c, like), take(listed.dz, c, like), distance0, gap)
    slip, curved = like, like
    if spring0 is not None:
        px, pz, before, sine, cosine = _turned(dx, dz, wx, wz)
        ai = gather(q, 2 * n, disks, c, 0, like) - gather(q0, 2 * n, disks, c, 0, like)
        aj = gather(q, 2 * n, disks, c, 1, like) - gather(q0, 2 * n, disks, c, 1, like)
        roll = gather(radius, 0, disks, c, 0, like) * ai + gather(radius, 0, disks, c, 1, like) * aj
        slip = 0.5 * (before + distance) * _angles(sine, cosine, room) - roll
        if step.fixed.size:
            ax = length * (gather(ahead, 0, disks, c, 0, like) - gather(ahead, 0, disks, c, 1, like))
            az = length * (gather(ahead, n, disks, c, 0, like) - gather(ahead, n, disks, c, 1, like))
            curved = _curved(px, pz, wx, wz, ax, az, 1.0 / distance0)
    put(out.nx, c, dx / distance)
    put(out.nz, c, dz / distance)
    return _fill(c, overlap, slip, curved, listed.pair_law, spring0, step, listed, out)


@kernel
def _fill_pairs(spring0, step, listed, room, out):
    """Fill in all pairs, eight at once; their largest bend and contradiction."""
    whole = listed.pairs - listed.pairs % WIDTH
    bends, wrongs, bend, worst = spread(0.0), spread(0.0), 0.0, 0.0
    for c in range(0, whole, WIDTH):
        bent8, wrong8 = fill_pair(c, spread(0.0), spring0, step, listed, room, out)
        bends, wrongs = select(bent8 > bends, bent8, bends), select(wrong8 > wrongs, wrong8, wrongs)
    for c in range(whole, listed.pairs):
        bent, wrong = fill_pair(c, 0.0, spring0, step, listed, room, out)
        bend, worst = select(bent > bend, bent, bend), select(wrong > worst, wrong, worst)
    put(room, 0, bends)
    put(room, WIDTH, wrongs)
    for k in range(WIDTH):
        bend, worst = max(bend, room[k]), max(worst, room[WIDTH + k])
    return bend, worst


@kernel
def _fill_walls(spring0, step, listed, out):
    """Fill in all contacts with walls; their largest contradiction."""
    q, q0, n, worst = step.q, step.q0, listed.radius.size, 0.0
    for c in range(listed.pairs, listed.gap.size):
        i, nx, nz = listed.disks[c, 0], listed.dx[c], listed.dz[c]
        slip = 0.0
        if spring0 is not None:
            slip = (q[n + i] - q0[n + i]) * nx - (q[i] - q0[i]) * nz
            slip -= listed.radius[i] * (q[2 * n + i] - q0[2 * n + i])
        out.nx[c], out.nz[c] = nx, nz
        overlap = at_wall(q[i], q[n + i], nx, nz, listed.gap[c])
        _, wrong = _fill(c, overlap, slip, 0.0, listed.wall_law, spring0, step, listed, out)
        worst = select(wrong > worst, wrong, worst)
    return worst


# Springs are arguments of their own, beside the increment that holds them: only of an argument does the compiler know
# that it is None.
@kernel
def contacts(step, pair_spring, wall_spring, listed, room, out, force):
    """Forces of the listed contacts at the end of an increment.

    Parameters
    ----------
    step, listed : :class:`Increment` and :class:`Listed`.
    pair_spring, wall_spring : ``step.spring``, None where these contacts have no friction.
    room : (2 WIDTH,) numbers.
    out : :class:`Response`, filled.
    force : (dof,) generalised contact force, added to.

    Returns
    -------
    Longest part of a spring that a curved way has made, and the largest force by which contacts with kept statuses
    differ from those by the return map.
    """
    bend, worst = _fill_pairs(pair_spring, step, listed, room, out)
    wrong = _fill_walls(wall_spring, step, listed, out)
    n, turns, radius = listed.radius.size, force.size == 3 * listed.radius.size, listed.radius
    for c in range(listed.gap.size):
        if out.status[c] == 0.0:
            continue
        i, j = listed.disks[c, 0], listed.disks[c, 1]
        normal, tangential, nx, nz = out.normal[c], out.tangential[c], out.nx[c], out.nz[c]
        fx, fz = normal * nx - tangential * nz, normal * nz + tangential * nx
        force[i] += fx
        force[n + i] += fz
        if turns:
            force[2 * n + i] -= radius[i] * tangential
        if j < 0:
            continue
        force[j] -= fx
        force[n + j] -= fz
        if turns:
            force[2 * n + j] -= radius[j] * tangential
    return bend, max(worst, wrong)


@kernel
def along_rolling(step, listed, out, force):
    """Fill in rolling resistance, where there is some, after :func:`contacts`; arguments as there.

    Returns the largest force by which those with kept statuses differ from those by the return map.
    """
    n, size, worst = listed.radius.size, listed.gap.size, 0.0
    for c in range(size):
        r = size + c
        out.tangential[r], out.spring[r], out.status[r] = 0.0, 0.0, 0.0
        stiff, most, _ = resistance(r, out.normal[c], listed)
        if out.status[c] == OPEN or stiff == 0.0:
            continue
        a, b = 2 * n + listed.disks[c, 0], 2 * n + listed.disks[c, 1]
        turned, arm = step.q[a] - step.q0[a], listed.arm[c]
        if b >= 2 * n:
            turned -= step.q[b] - step.q0[b]
        trial = step.spring[r] + _closed_part(step.overlap[c], out.overlap[c]) * arm * turned
        found, spring, sense, wrong = _returned(trial, _given(step.limits, r, most), stiff, r, step.fixed)
        worst = max(worst, wrong)
        out.tangential[r], out.spring[r] = found, spring
        out.status[r] = sense if abs(sense) > STICKING else float(STICKING)
        force[a] += arm * found
        if b >= 2 * n:
            force[b] -= arm * found
    return worst


@kernel
def tangents(q, q0, overlap0, follow, listed, out, tangent):
    """Fill ``tangent`` with the local tangents of contacts whose forces are ``out``, as :func:`contacts` made them.

    (m + w, 3, 3), or (m + w, 4, 3) with the derivative of the couple on the first disk, by relative displacement and
    rotation, in the last row. ``follow`` : whether limits follow the normal force, or are fixed.
    """
    n, size = listed.radius.size, overlap0.size
    for c in range(size):
        status, xi = out.status[c], out.overlap[c]
        if status == 0.0:
            tangent[c, :, :] = 0.0
            continue
        tangent[c, 3:, :] = 0.0
        i, j, nx, nz, _, k = contact_at(c, q, listed)
        law, normal, share = law_of(listed, c), out.normal[c], _closed_part(overlap0[c], xi)
        stiff, slip_n, slides, inverse = law.tangential_stiffness * share, 0.0, 0.0, 0.0
        mean, distance = 1.0, 1.0
        if j >= 0:
            ux, uz = q[i] - q[j], q[n + i] - q[n + j]
            dx, dz, distance, _ = displaced(ux, uz, listed.dx[c], listed.dz[c], listed.distance[c], listed.gap[c])
            wx, wz = ux - (q0[i] - q0[j]), uz - (q0[n + i] - q0[n + j])
            _, _, before, sine, cosine = _turned(dx, dz, wx, wz)
            inverse = 1.0 / distance
            mean = 0.5 * (before + distance)
            slip_n = 0.5 * _angle(sine, cosine)
        if abs(status) > STICKING:
            stiff = 0.0
            if follow:
                slides = limit_slope(law, normal) if status > 0.0 else -limit_slope(law, normal)
        # d f_n = -k n.w; d f_t = slides d f_n - stiff (slip_n n + mean / distance t).w + stiff rho;
        # d n = inverse (t.w) t; d t = -inverse (t.w) n
        g, tx, tz = tangent[c], -nz, nx
        ft_n, ft_t = -(stiff * slip_n) - slides * k, -(stiff * mean / distance)
        for col in range(2):
            n_c, t_c = (nx, tx) if col == 0 else (nz, tz)
            dfn, dft = -k * n_c, ft_n * n_c + ft_t * t_c
            along_n, along_t = dfn - out.tangential[c] * inverse * t_c, dft + normal * inverse * t_c
            g[0, col], g[1, col], g[2, col] = along_n * nx + along_t * tx, along_n * nz + along_t * tz, dft
        g[0, 2], g[1, 2], g[2, 2] = stiff * tx, stiff * tz, stiff
        if out.status.size == size or out.status[size + c] == 0.0:
            continue
        status, arm = out.status[size + c], listed.arm[c]
        stiff, _, slope = resistance(size + c, normal, listed)
        if abs(status) > STICKING:
            slides = (1.0 if status > 0.0 else -1.0) * slope * k * arm if follow else 0.0
            tangent[c, 3, 0], tangent[c, 3, 1] = -slides * nx, -slides * nz
        else:
            tangent[c, 3, 2] = -arm * arm * stiff * share


@kernel
def normal_forces(overlap, shape, law, out):
    """Fill ``out`` (:class:`Response`) with normal forces from overlaps (m,), its contacts OPEN or STICKING."""
    for c in range(overlap.size):
        closed = overlap[c] > 0.0
        out.overlap[c], out.status[c] = overlap[c], STICKING if closed else OPEN
        if closed:
            out.normal[c] = elastic_force(law, overlap[c], take(shape, c, 0.0))


@kernel
def spring_forces(row, spring, law, out):
    """Fill a ``row`` of closed contacts after :func:`normal_forces`, from springs (m,) as they are.

    A contact slides when its spring force has reached the limit (to ``AT_LIMIT`` of it).
    """
    for c in range(spring.size):
        if out.status[c] == OPEN:
            continue
        r, force = row * spring.size + c, -law.tangential_stiffness * spring[c]
        out.spring[r], out.tangential[r] = spring[c], force
        reached = abs(force) >= limit(law, abs(out.normal[c])) * (1 - AT_LIMIT)
        out.status[r] = SLIDING if reached else STICKING


def elastic_energy(overlap, shape, law) -> float:
    """Energy of the normal springs of contacts (m,)."""
    energies = np.zeros(len(overlap))
    _elastic_energies(overlap, shape, law, energies)
    return float(energies.sum())


@kernel
def _elastic_energies(overlap, shape, law, out):
    """Fill ``out`` (m,)."""
    for c in range(overlap.size):
        out[c] = energy(law, overlap[c], take(shape, c, 0.0)) if overlap[c] > 0.0 else 0.0


@kernel(forceinline=True)
def _add_block(data, base, stride, g, row_sign, row_arm, col_sign, col_arm, freedoms):
    """Add -L G Z to the block at ``data[base]``; L = diag(s, s, -R), Z = diag(s, s, R)."""
    for b in range(freedoms):
        zb = col_arm if b == 2 else col_sign
        for a in range(freedoms):
            la = -row_arm if a == 2 else row_sign
            data[base + b * stride + a] -= la * g[a, b] * zb


@kernel
def assemble(data, freedoms, listed, tangent, base, stride):
    """Sum local tangents into the values of a column-compressed matrix, ``K = -d F / d q``.

    Unknowns are interleaved, ``freedoms * place + component``. ``tangent`` : as :func:`tangents` fills it; ``base`` :
    (m + w, 4) positions in ``data`` of the blocks (i, i), (i, j), (j, i), (j, j) (row, column), of which walls have the
    first; ``stride`` : (m + w, 4) distance between two columns of each.
    """
    data[:] = 0.0
    size, radius = listed.gap.size, listed.radius
    for c in range(size):
        i, j, g = listed.disks[c, 0], listed.disks[c, 1], tangent[c]
        ri = radius[i]
        _add_block(data, base[c, 0], stride[c, 0], g, 1.0, ri, 1.0, ri, freedoms)
        if j >= 0:
            rj = radius[j]
            _add_block(data, base[c, 1], stride[c, 1], g, 1.0, ri, -1.0, rj, freedoms)
            _add_block(data, base[c, 2], stride[c, 2], g, -1.0, rj, 1.0, ri, freedoms)
            _add_block(data, base[c, 3], stride[c, 3], g, -1.0, rj, -1.0, rj, freedoms)
    if tangent.shape[1] == 3:
        return
    for c in range(size):
        for block in range(4 if listed.disks[c, 1] >= 0 else 1):
            sign = 1.0 if block == 0 or block == 3 else -1.0
            for b in range(3):
                data[base[c, block] + b * stride[c, block] + 2] -= sign * tangent[c, 3, b]
