"""Force loops.

Candidate contacts of disks are stored as *runs*: ``(first disk, second disk, count, first slot)``, that is
the pairs ``(i + k, j + k)`` for ``k < count``. On a lattice numbered row by row the whole network is three
runs, one for each lattice direction, and the loop over a run reads and writes contiguous memory, so that the
compiler vectorises it. A run may hold pairs that never touch (the end of a row and the start of the next):
they cost a little arithmetic and no branch. Pairs that fit no run are runs of count one at the end of the
table; they are looped over apart, and most of the work is left out for those that do not touch.

Every pair force of a run goes to a buffer first and is then added to its two disks in a fixed order, so results
do not depend on vector width.
"""

from __future__ import annotations

import math

import numba as nb

from .law import LITERAL, normal_force, tangential_cut, tangential_literal


@nb.njit(cache=True, error_model="numpy")
def _frictionless_run(x0, x1, z0, z1, u0, u1, w0, w1, dx0, dz0, reach, fx, fz, law):
    for k in range(x0.size):
        dx = dx0[k] + (x0[k] - x1[k])
        dz = dz0[k] + (z0[k] - z1[k])
        distance = math.sqrt(dx * dx + dz * dz)
        inverse = 1.0 / distance
        nx = dx * inverse
        nz = dz * inverse
        overlap = reach[k] - distance
        fn = normal_force(overlap, (u0[k] - u1[k]) * nx + (w0[k] - w1[k]) * nz, law)
        fn = fn if overlap > 0.0 else 0.0
        fx[k] = fn * nx
        fz[k] = fn * nz


@nb.njit(cache=True, error_model="numpy")
def _cut_run(x0, x1, z0, z1, u0, u1, w0, w1, s0, s1, dx0, dz0, reach, spring, fx, fz, ft, law, dt):
    for k in range(x0.size):
        dx = dx0[k] + (x0[k] - x1[k])
        dz = dz0[k] + (z0[k] - z1[k])
        distance = math.sqrt(dx * dx + dz * dz)
        inverse = 1.0 / distance
        nx = dx * inverse
        nz = dz * inverse
        overlap = reach[k] - distance
        du = u0[k] - u1[k]
        dw = w0[k] - w1[k]
        fn = normal_force(overlap, du * nx + dw * nz, law)
        force, new = tangential_cut(spring[k], dw * nx - du * nz - (s0[k] + s1[k]), fn, law, dt)
        fn = fn if overlap > 0.0 else 0.0
        force = force if overlap > 0.0 else 0.0
        spring[k] = new if overlap > 0.0 else 0.0
        fx[k] = fn * nx - force * nz
        fz[k] = fn * nz + force * nx
        ft[k] = force


@nb.njit(cache=True, error_model="numpy")
def _literal_run(x0, x1, z0, z1, u0, u1, w0, w1, s0, s1, dx0, dz0, reach, spring, fx, fz, ft, law, dt):
    for k in range(x0.size):
        dx = dx0[k] + (x0[k] - x1[k])
        dz = dz0[k] + (z0[k] - z1[k])
        distance = math.sqrt(dx * dx + dz * dz)
        inverse = 1.0 / distance
        nx = dx * inverse
        nz = dz * inverse
        overlap = reach[k] - distance
        du = u0[k] - u1[k]
        dw = w0[k] - w1[k]
        fn = normal_force(overlap, du * nx + dw * nz, law)
        force, new = tangential_literal(spring[k], dw * nx - du * nz - (s0[k] + s1[k]), fn, law, dt)
        fn = fn if overlap > 0.0 else 0.0
        force = force if overlap > 0.0 else 0.0
        spring[k] = new if overlap > 0.0 else 0.0
        fx[k] = fn * nx - force * nz
        fz[k] = fn * nz + force * nx
        ft[k] = force


@nb.njit(cache=True, error_model="numpy")
def _add(target, values):
    for k in range(values.size):
        target[k] += values[k]


@nb.njit(cache=True, error_model="numpy")
def _subtract(target, values):
    for k in range(values.size):
        target[k] -= values[k]


@nb.njit(cache=True, error_model="numpy")
def _add_single_pairs(q, v, rim, f, n, singles, dx0, dz0, reach, spring, law, rule, dt):
    """Add the forces of the runs of count one, ``singles`` (s, 4); other arguments as in :func:`add_pair_forces`."""
    for r in range(singles.shape[0]):
        i = singles[r, 0]
        j = singles[r, 1]
        k = singles[r, 3]
        dx = dx0[k] + (q[i] - q[j])
        dz = dz0[k] + (q[n + i] - q[n + j])
        square = dx * dx + dz * dz
        if square >= reach[k] * reach[k]:
            if spring is not None:
                spring[k] = 0.0
            continue
        distance = math.sqrt(square)
        inverse = 1.0 / distance
        nx = dx * inverse
        nz = dz * inverse
        du = v[i] - v[j]
        dw = v[n + i] - v[n + j]
        fn = normal_force(reach[k] - distance, du * nx + dw * nz, law)
        px = fn * nx
        pz = fn * nz
        if spring is not None:
            slip = dw * nx - du * nz - (rim[i] + rim[j])
            if rule == LITERAL:
                force, new = tangential_literal(spring[k], slip, fn, law, dt)
            else:
                force, new = tangential_cut(spring[k], slip, fn, law, dt)
            spring[k] = new
            px -= force * nz
            pz += force * nx
            f[2 * n + i] += force
            f[2 * n + j] += force
        f[i] += px
        f[j] -= px
        f[n + i] += pz
        f[n + j] -= pz


@nb.njit(cache=True, error_model="numpy")
def add_pair_forces(q, v, rim, f, n, runs, dx0, dz0, reach, spring, buffer, law, rule, dt):
    """Add the forces of all disk-disk candidates to ``f``.

    Parameters
    ----------
    q, v, f : (2 n,) or (3 n,) generalised displacements, velocities, forces. With friction the third part
        of ``f`` collects the sum of tangential forces, not yet multiplied by ``-radius``.
    rim : (n,) radius times angular velocity, or None without friction.
    runs : (r, 4) int64 candidate runs, those of count one last; ``dx0``, ``dz0``, ``reach`` : (m,) reference
        separation and sum of radii of each slot; ``spring`` : (m,) tangential springs, updated in place, or None
        without friction.
    buffer : (3, m) or (2, m) scratch.
    law : tuple, see ``core.law``; ``rule`` : CUT or LITERAL; ``dt`` : time step of the spring update.
    """
    x = q[:n]
    z = q[n : 2 * n]
    u = v[:n]
    w = v[n : 2 * n]
    fx = f[:n]
    fz = f[n : 2 * n]
    for r in range(runs.shape[0]):
        i0 = runs[r, 0]
        j0 = runs[r, 1]
        count = runs[r, 2]
        s0 = runs[r, 3]
        if count == 1:
            _add_single_pairs(q, v, rim, f, n, runs[r:], dx0, dz0, reach, spring, law, rule, dt)
            break
        i1 = i0 + count
        j1 = j0 + count
        s1 = s0 + count
        px = buffer[0, s0:s1]
        pz = buffer[1, s0:s1]
        if spring is None:
            _frictionless_run(
                x[i0:i1], x[j0:j1], z[i0:i1], z[j0:j1], u[i0:i1], u[j0:j1], w[i0:i1], w[j0:j1],
                dx0[s0:s1], dz0[s0:s1], reach[s0:s1], px, pz, law,
            )  # fmt: skip
        else:
            pt = buffer[2, s0:s1]
            if rule == LITERAL:
                _literal_run(
                    x[i0:i1], x[j0:j1], z[i0:i1], z[j0:j1], u[i0:i1], u[j0:j1], w[i0:i1], w[j0:j1],
                    rim[i0:i1], rim[j0:j1], dx0[s0:s1], dz0[s0:s1], reach[s0:s1], spring[s0:s1],
                    px, pz, pt, law, dt,
                )  # fmt: skip
            else:
                _cut_run(
                    x[i0:i1], x[j0:j1], z[i0:i1], z[j0:j1], u[i0:i1], u[j0:j1], w[i0:i1], w[j0:j1],
                    rim[i0:i1], rim[j0:j1], dx0[s0:s1], dz0[s0:s1], reach[s0:s1], spring[s0:s1],
                    px, pz, pt, law, dt,
                )  # fmt: skip
            ft = f[2 * n :]
            _add(ft[i0:i1], pt)
            _add(ft[j0:j1], pt)
        _add(fx[i0:i1], px)
        _subtract(fx[j0:j1], px)
        _add(fz[i0:i1], pz)
        _subtract(fz[j0:j1], pz)


@nb.njit(cache=True, error_model="numpy")
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


@nb.njit(cache=True, error_model="numpy")
def accelerations(
    q, v, a, gravity, load_factor, dt,
    n, weight, inverse_mass, radius, rim, load, load_disk,
    runs, dx0, dz0, reach, spring, buffer, pair_law,
    wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule,
):  # fmt: skip
    """Fill ``a`` with all accelerations at ``(q, v)``; springs advance by ``dt``.

    The arguments from ``n`` on describe the scene and stay the same from step to step; integrators pass them
    as one tuple, the *model*. ``weight`` : (n,), multiplied by ``gravity``; ``load`` : (l, 3) force and torque
    on the disks ``load_disk`` (l,), multiplied by ``load_factor``; ``inverse_mass`` : like ``q``, moments of
    inertia included; ``rim`` : (n,) scratch, or None without rotations.
    """
    for i in range(n):
        a[i] = 0.0
    for i in range(n):
        a[n + i] = -gravity * weight[i]
    if rim is not None:
        spin = v[2 * n :]
        total = a[2 * n :]
        for i in range(n):
            rim[i] = radius[i] * spin[i]
            total[i] = 0.0
    add_pair_forces(q, v, rim, a, n, runs, dx0, dz0, reach, spring, buffer, pair_law, rule, dt)
    add_wall_forces(q, v, rim, a, n, wall_disk, wall_normal, wall_gap, wall_spring, wall_law, rule, dt)
    if rim is not None:
        total = a[2 * n :]
        for i in range(n):
            total[i] *= -radius[i]
    for c in range(load_disk.size):
        i = load_disk[c]
        a[i] += load_factor * load[c, 0]
        a[n + i] += load_factor * load[c, 1]
        if rim is not None:
            a[2 * n + i] += load_factor * load[c, 2]
    for k in range(a.size):
        a[k] *= inverse_mass[k]
