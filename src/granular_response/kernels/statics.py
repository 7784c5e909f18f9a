"""Static contact forces by the return map, and their consistent tangent.

The quasi-static limit of the contact law over one increment: from a converged configuration (displacements
``q0``, springs ``spring0``) to a trial one ``q``, each tangential spring is stretched by the relative tangential
displacement of the increment and then cut to the Coulomb limit. The displacement is integrated over the
increment with the current normal (Delta s = mean distance times the turn of the normal minus the rolling part),
so there is no linearised geometry. A contact that closes within the increment collects slip only from where
it closed.

Vectors are laid out ``[x | z | angle]`` as everywhere in ``kernels``. For contact ``c`` the local tangent
``G[c]`` (3, 3) is the derivative of ``(f_x, f_z, f_t)`` on the first disk with respect to
``(w_x, w_z, rho)``, the relative displacement and ``R_i theta_i + R_j theta_j``.
"""

from __future__ import annotations

import math

from ..machine.machine_code import kernel
from ..state.status import OPEN, SLIDING, STICKING


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


@kernel
def pair_statics(
    q, q0, n, first, second, dx0, dz0, gap0, radius, overlap0, spring0, limits, law,
    overlap, normal, tangential, spring, status, force, g,
):  # fmt: skip
    """Forces of disk-disk contacts at ``q`` and their local tangents.

    ``dx0, dz0, gap0`` : (m,) separation and gap at zero displacement; ``overlap0, spring0`` : (m,) at ``q0``
    (``spring0`` None without friction). Filled: ``overlap, normal, tangential, spring, status`` (m,), the
    generalised contact force ``force`` (dof,) is added to, and ``g`` (m, 3, 3). ``limits`` : (m,) gives every
    contact a fixed Coulomb limit in place of ``mu f_n`` (None: the true law); the tangent is then symmetric.
    """
    k, kt, mu = law[0], law[2], law[4]
    for c in range(first.size):
        i = first[c]
        j = second[c]
        ux = q[i] - q[j]
        uz = q[n + i] - q[n + j]
        d0 = math.sqrt(dx0[c] * dx0[c] + dz0[c] * dz0[c])
        dx = dx0[c] + ux
        dz = dz0[c] + uz
        d = math.sqrt(dx * dx + dz * dz)
        # |d| - |d0| without cancellation
        stretch = (2.0 * (dx0[c] * ux + dz0[c] * uz) + ux * ux + uz * uz) / (d + d0)
        xi = -(gap0[c] + stretch)
        overlap[c] = xi
        if xi <= 0.0:
            status[c] = OPEN
            normal[c] = 0.0
            if spring0 is not None:
                tangential[c] = 0.0
                spring[c] = 0.0
            g[c, :, :] = 0.0
            continue
        nx = dx / d
        nz = dz / d
        fn = k * xi
        normal[c] = fn
        status[c] = STICKING
        if spring0 is None:
            force[i] += fn * nx
            force[n + i] += fn * nz
            force[j] -= fn * nx
            force[n + j] -= fn * nz
            _fill_tangent(g[c], nx, nz, fn, 0.0, 1.0 / d, k, 0.0, 0.0, 0.0, 0.0)
            continue
        wx = ux - (q0[i] - q0[j])
        wz = uz - (q0[n + i] - q0[n + j])
        px = dx - wx
        pz = dz - wz
        before = math.sqrt(px * px + pz * pz)
        turn = math.atan2(px * wz - pz * wx, px * dx + pz * dz)
        mean = 0.5 * (before + d)
        roll = radius[i] * (q[2 * n + i] - q0[2 * n + i]) + radius[j] * (q[2 * n + j] - q0[2 * n + j])
        share = 1.0 if overlap0[c] >= 0.0 else xi / (xi - overlap0[c])
        s = spring0[c] + share * (mean * turn - roll)
        ft = -kt * s
        limit = mu * fn if limits is None else limits[c]
        if abs(ft) > limit:
            sign = 1.0 if ft > 0.0 else -1.0
            ft = sign * limit
            s = -ft / kt
            status[c] = SLIDING
            _fill_tangent(g[c], nx, nz, fn, ft, 1.0 / d, k, 0.0, 0.0, 0.0, sign * mu if limits is None else 0.0)
        else:
            stiff = kt * share
            _fill_tangent(
                g[c], nx, nz, fn, ft, 1.0 / d, k, stiff * mean / d, stiff * 0.5 * turn, stiff, 0.0
            )  # fmt: skip
        tangential[c] = ft
        spring[c] = s
        fx = fn * nx - ft * nz
        fz = fn * nz + ft * nx
        force[i] += fx
        force[n + i] += fz
        force[j] -= fx
        force[n + j] -= fz
        force[2 * n + i] -= radius[i] * ft
        force[2 * n + j] -= radius[j] * ft


@kernel
def wall_statics(
    q, q0, n, disk, wall_normal, gap0, radius, overlap0, spring0, limits, law,
    overlap, normal, tangential, spring, status, force, g,
):  # fmt: skip
    """As :func:`pair_statics` for disk-wall contacts; ``wall_normal`` : (w, 2)."""
    k, kt, mu = law[0], law[2], law[4]
    for c in range(disk.size):
        i = disk[c]
        nx = wall_normal[c, 0]
        nz = wall_normal[c, 1]
        xi = -(gap0[c] + q[i] * nx + q[n + i] * nz)
        overlap[c] = xi
        if xi <= 0.0:
            status[c] = OPEN
            normal[c] = 0.0
            if spring0 is not None:
                tangential[c] = 0.0
                spring[c] = 0.0
            g[c, :, :] = 0.0
            continue
        fn = k * xi
        normal[c] = fn
        status[c] = STICKING
        ft = 0.0
        if spring0 is None:
            _fill_tangent(g[c], nx, nz, fn, 0.0, 0.0, k, 0.0, 0.0, 0.0, 0.0)
        else:
            slip = (q[n + i] - q0[n + i]) * nx - (q[i] - q0[i]) * nz
            slip -= radius[i] * (q[2 * n + i] - q0[2 * n + i])
            share = 1.0 if overlap0[c] >= 0.0 else xi / (xi - overlap0[c])
            s = spring0[c] + share * slip
            ft = -kt * s
            limit = mu * fn if limits is None else limits[c]
            if abs(ft) > limit:
                sign = 1.0 if ft > 0.0 else -1.0
                ft = sign * limit
                s = -ft / kt
                status[c] = SLIDING
                _fill_tangent(g[c], nx, nz, fn, ft, 0.0, k, 0.0, 0.0, 0.0, sign * mu if limits is None else 0.0)
            else:
                stiff = kt * share
                _fill_tangent(g[c], nx, nz, fn, ft, 0.0, k, stiff, 0.0, stiff, 0.0)
            tangential[c] = ft
            spring[c] = s
            force[2 * n + i] -= radius[i] * ft
        force[i] += fn * nx - ft * nz
        force[n + i] += fn * nz + ft * nx


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
