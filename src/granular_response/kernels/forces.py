"""Force loops.

Candidate contacts of disks are stored as *runs*: ``(first disk, second disk, count, first slot)``, that is
the pairs ``(i + k, j + k)`` for ``k < count``. On a lattice numbered row by row the whole network is three
runs, one for each lattice direction, and the loop over a run reads and writes contiguous memory, so it takes
several pairs at once (``machine.lanes``). A run may hold pairs that never touch (the end of a row and the start of the
next): they cost a little arithmetic and no branch. Pairs that fit no run are runs of count one at the end of the
table; what their disks do is gathered from all over the arrays, several pairs at a time too.

Results do not depend on how many pairs are taken at once: a run is gone through from its end, so that a disk gets
the force of the pair it is first in before that of the pair it is second in, also when one vector holds both.
"""

from __future__ import annotations

from ..contact.linear import LITERAL, normal_force, tangential_cut, tangential_literal
from ..contact.pair import frictional_pair, frictionless_pair
from ..machine.lanes import WIDTH, gather, put, spread, take
from ..machine.machine_code import kernel

#: Pairs of a run of close indices whose forces are held back before they are added to their second disks: memory
#: that one vector has just written at another offset cannot be read again at once.
_BLOCK = 64
#: Length of the scratch that this takes.
SCRATCH = 3 * _BLOCK


@kernel(forceinline=True)
def _forces_at(like, i, j, s, n, q, v, rim, dx0, dz0, reach, spring, law, rule, dt):
    """Force on the first disk, and its tangential part, of the pair of disks ``i`` and ``j`` in slot ``s``.

    Or of as many pairs from there on as ``like`` has lanes. Springs advance.
    """
    dx = take(dx0, s, like) + (take(q, i, like) - take(q, j, like))
    dz = take(dz0, s, like) + (take(q, n + i, like) - take(q, n + j, like))
    du = take(v, i, like) - take(v, j, like)
    dw = take(v, n + i, like) - take(v, n + j, like)
    if spring is None:
        px, pz = frictionless_pair(dx, dz, du, dw, take(reach, s, like), law)
        return px, pz, like
    rims = take(rim, i, like) + take(rim, j, like)
    px, pz, pt, new = frictional_pair(
        dx, dz, du, dw, rims, take(reach, s, like), take(spring, s, like), law, rule, dt
    )  # fmt: skip
    put(spring, s, new)
    return px, pz, pt


@kernel(forceinline=True)
def _add(f, n, i, px, pz, pt, spring):
    """Add to the forces on disk ``i``, and the disks after it with lanes."""
    put(f, i, take(f, i, px) + px)
    put(f, n + i, take(f, n + i, pz) + pz)
    if spring is not None:
        put(f, 2 * n + i, take(f, 2 * n + i, pt) + pt)


@kernel
def _add_run(i, j, s, count, n, q, v, rim, f, dx0, dz0, reach, spring, scratch, law, rule, dt):
    """Add the forces of ``count`` pairs from disks ``i``, ``j`` and slot ``s`` on."""
    k = count
    while k % WIDTH:
        k -= 1
        px, pz, pt = _forces_at(0.0, i + k, j + k, s + k, n, q, v, rim, dx0, dz0, reach, spring, law, rule, dt)
        _add(f, n, i + k, px, pz, pt, spring)
        _add(f, n, j + k, -px, -pz, pt, spring)
    like = spread(0.0)
    if j - i >= WIDTH:
        while k:
            k -= WIDTH
            px, pz, pt = _forces_at(like, i + k, j + k, s + k, n, q, v, rim, dx0, dz0, reach, spring, law, rule, dt)
            _add(f, n, i + k, px, pz, pt, spring)
            _add(f, n, j + k, -px, -pz, pt, spring)
        return
    while k:
        end = k
        start = max(k - _BLOCK, 0)
        while k > start:
            k -= WIDTH
            px, pz, pt = _forces_at(like, i + k, j + k, s + k, n, q, v, rim, dx0, dz0, reach, spring, law, rule, dt)
            _add(f, n, i + k, px, pz, pt, spring)
            put(scratch, k - start, px)
            put(scratch, _BLOCK + k - start, pz)
            if spring is not None:
                put(scratch, 2 * _BLOCK + k - start, pt)
        while end > start:
            end -= WIDTH
            px = take(scratch, end - start, like)
            pz = take(scratch, _BLOCK + end - start, like)
            pt = take(scratch, 2 * _BLOCK + end - start, like)
            _add(f, n, j + end, -px, -pz, pt, spring)


@kernel
def _add_single_pairs(q, v, rim, f, n, singles, dx0, dz0, reach, spring, scratch, law, rule, dt):
    """Add the forces of the runs of count one, ``singles`` (s, 4), several at once.

    Their slots follow one another. Other arguments as in :func:`add_pair_forces`.
    """
    count = singles.shape[0]
    whole = count - count % WIDTH
    like = spread(0.0)
    for r in range(0, whole, WIDTH):
        s = singles[r, 3]
        dx = take(dx0, s, like) + (gather(q, 0, singles, r, 0) - gather(q, 0, singles, r, 1))
        dz = take(dz0, s, like) + (gather(q, n, singles, r, 0) - gather(q, n, singles, r, 1))
        du = gather(v, 0, singles, r, 0) - gather(v, 0, singles, r, 1)
        dw = gather(v, n, singles, r, 0) - gather(v, n, singles, r, 1)
        if spring is None:
            px, pz = frictionless_pair(dx, dz, du, dw, take(reach, s, like), law)
        else:
            rims = gather(rim, 0, singles, r, 0) + gather(rim, 0, singles, r, 1)
            px, pz, pt, new = frictional_pair(
                dx, dz, du, dw, rims, take(reach, s, like), take(spring, s, like), law, rule, dt
            )  # fmt: skip
            put(spring, s, new)
            put(scratch, 2 * WIDTH, pt)
        put(scratch, 0, px)
        put(scratch, WIDTH, pz)
        for lane in range(WIDTH):
            i = singles[r + lane, 0]
            j = singles[r + lane, 1]
            f[i] += scratch[lane]
            f[j] -= scratch[lane]
            f[n + i] += scratch[WIDTH + lane]
            f[n + j] -= scratch[WIDTH + lane]
            if spring is not None:
                f[2 * n + i] += scratch[2 * WIDTH + lane]
                f[2 * n + j] += scratch[2 * WIDTH + lane]
    for r in range(whole, count):
        i = singles[r, 0]
        j = singles[r, 1]
        px, pz, pt = _forces_at(
            0.0, i, j, singles[r, 3], n, q, v, rim, dx0, dz0, reach, spring, law, rule, dt
        )  # fmt: skip
        _add(f, n, i, px, pz, pt, spring)
        _add(f, n, j, -px, -pz, pt, spring)


@kernel
def add_pair_forces(q, v, rim, f, n, runs, dx0, dz0, reach, spring, scratch, law, rule, dt):
    """Add the forces of all disk-disk candidates to ``f``.

    Parameters
    ----------
    q, v, f : (2 n,) or (3 n,) generalised displacements, velocities, forces. With friction the third part
        of ``f`` collects the sum of tangential forces, not yet multiplied by ``-radius``.
    rim : (n,) radius times angular velocity, or None without friction.
    runs : (r, 4) int64 candidate runs, those of count one last; ``dx0``, ``dz0``, ``reach`` : (m,) reference
        separation and sum of radii of each slot; ``spring`` : (m,) tangential springs, updated in place, or None
        without friction.
    scratch : (SCRATCH,).
    law : tuple, see ``contact.linear``; ``rule`` : CUT or LITERAL; ``dt`` : time step of the spring update.
    """
    for r in range(runs.shape[0]):
        i = runs[r, 0]
        j = runs[r, 1]
        count = runs[r, 2]
        s = runs[r, 3]
        if count == 1:
            _add_single_pairs(q, v, rim, f, n, runs[r:], dx0, dz0, reach, spring, scratch, law, rule, dt)
            break
        _add_run(i, j, s, count, n, q, v, rim, f, dx0, dz0, reach, spring, scratch, law, rule, dt)


@kernel
def add_wall_forces(q, v, rim, f, n, disk, normal, gap0, spring, law, rule, dt):
    """Add the forces of the listed disk-wall candidates to ``f``.

    ``disk`` : (w,) disks that can touch a wall; ``normal`` : (w, 2) inward normals; ``gap0`` : (w,) reference
    gap; ``spring`` : (w,) or None for frictionless walls. Other arguments as in :func:`add_pair_forces`.
    """
    for c in range(disk.size):
        i = disk[c]
        nx = normal[c, 0]
        nz = normal[c, 1]
        overlap = -(gap0[c] + q[i] * nx + q[n + i] * nz)
        if overlap > 0.0:
            fn = normal_force(overlap, v[i] * nx + v[n + i] * nz, law)
            f[i] += fn * nx
            f[n + i] += fn * nz
            if spring is not None:
                slip = v[n + i] * nx - v[i] * nz - rim[i]
                if rule == LITERAL:
                    force, new = tangential_literal(spring[c], slip, fn, law, dt)
                else:
                    force, new = tangential_cut(spring[c], slip, fn, law, dt)
                spring[c] = new
                f[i] -= force * nz
                f[n + i] += force * nx
                f[2 * n + i] += force
        elif spring is not None:
            spring[c] = 0.0


@kernel
def forces(
    q, v, f, gravity, load_factor, dt,
    n, weight, inverse_mass, radius, rim, load, load_disk,
    runs, dx0, dz0, reach, spring, scratch, pair_law,
    wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule,
):  # fmt: skip
    """Fill ``f`` with all forces and torques at ``(q, v)``; springs advance by ``dt``.

    The arguments from ``n`` on describe the scene and stay the same from step to step; integrators pass them
    as one tuple, the *model*. ``weight`` : (n,), multiplied by ``gravity``; ``load`` : (l, 3) force and torque
    on the disks ``load_disk`` (l,), multiplied by ``load_factor``; ``inverse_mass`` : like ``q``, moments of
    inertia included, for those who need accelerations; ``rim`` : (n,) scratch, or None without rotations.
    """
    for i in range(n):
        f[i] = 0.0
    for i in range(n):
        f[n + i] = -gravity * weight[i]
    if rim is not None:
        spin = v[2 * n :]
        total = f[2 * n :]
        for i in range(n):
            rim[i] = radius[i] * spin[i]
            total[i] = 0.0
    add_pair_forces(q, v, rim, f, n, runs, dx0, dz0, reach, spring, scratch, pair_law, rule, dt)
    add_wall_forces(q, v, rim, f, n, wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule, dt)
    if rim is not None:
        total = f[2 * n :]
        for i in range(n):
            total[i] *= -radius[i]
    for c in range(load_disk.size):
        i = load_disk[c]
        f[i] += load_factor * load[c, 0]
        f[n + i] += load_factor * load[c, 1]
        if rim is not None:
            f[2 * n + i] += load_factor * load[c, 2]


@kernel
def accelerations(q, v, a, gravity, load_factor, dt, model):
    """Fill ``a`` with all accelerations; arguments as of :func:`forces`."""
    forces(q, v, a, gravity, load_factor, dt, *model)
    inverse_mass = model[2]
    for k in range(a.size):
        a[k] *= inverse_mass[k]
