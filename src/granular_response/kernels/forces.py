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

from ..contact.coulomb import CUT, tangential
from ..contact.geometry import at_wall, between
from ..contact.law import frictional, frictionless, normal_force
from ..machine.lanes import WIDTH, gather, put, select, spread, take
from ..machine.machine_code import kernel
from .model import Motion

#: Length of the scratch for what single pairs add.
SCRATCH = 4 * WIDTH


@kernel(forceinline=True)
def _couples(overlap, normal, spin, c, rolls, dt):
    """Couple on the first body of contact ``c``, or of several from there on; springs advance."""
    arm = take(rolls.arm, c, overlap)
    force, new = tangential(take(rolls.spring, c, overlap), arm * spin, normal, rolls.law, CUT, dt)
    put(rolls.spring, c, select(overlap > 0.0, new, 0.0))
    return select(overlap > 0.0, arm * force, 0.0)


@kernel(forceinline=True)
def _forces(like, i, j, s, table, spring, rolls, pairs, motion):
    """Force on the first disk, its tangential part, and couple, of the disks ``i`` and ``j`` with slot ``s``.

    Or of as many pairs from there on as ``like`` has lanes; with a ``table`` those in its rows. Springs advance.
    """
    n, q, v, rim = motion.n, motion.q, motion.v, motion.rim
    dx = take(pairs.dx, s, like) + (gather(q, 0, table, i, 0, like) - gather(q, 0, table, j, 1, like))
    dz = take(pairs.dz, s, like) + (gather(q, n, table, i, 0, like) - gather(q, n, table, j, 1, like))
    du = gather(v, 0, table, i, 0, like) - gather(v, 0, table, j, 1, like)
    dw = gather(v, n, table, i, 0, like) - gather(v, n, table, j, 1, like)
    overlap, nx, nz = between(dx, dz, take(pairs.reach, s, like))
    normal = normal_force(overlap, take(pairs.shape, s, like), du * nx + dw * nz, pairs.law)
    if spring is None:
        px, pz = frictionless(overlap, nx, nz, normal)
        return px, pz, like, like
    rims = gather(rim, 0, table, i, 0, like) + gather(rim, 0, table, j, 1, like)
    slip, before = dw * nx - du * nz - rims, take(spring, s, like)
    px, pz, pt, new = frictional(overlap, nx, nz, normal, slip, before, pairs.law, motion.rule, motion.dt)
    put(spring, s, new)
    if rolls is None:
        return px, pz, pt, like
    spin = gather(v, 2 * n, table, i, 0, like) - gather(v, 2 * n, table, j, 1, like)
    return px, pz, pt, _couples(overlap, normal, spin, s, rolls, motion.dt)


@kernel(forceinline=True)
def _add(i, px, pz, pt, pc, spring, rolls, motion):
    """Add to the forces on disk ``i``, and the disks after it with lanes."""
    f, n = motion.f, motion.n
    put(f, i, take(f, i, px) + px)
    put(f, n + i, take(f, n + i, pz) + pz)
    if spring is not None:
        put(f, 2 * n + i, take(f, 2 * n + i, pt) + pt)
    if rolls is not None:
        put(rolls.couple, i, take(rolls.couple, i, pc) + pc)


@kernel
def _add_run(r, spring, rolls, pairs, motion):
    """Add the forces of run ``r``."""
    i = pairs.runs[r, 0]
    j = pairs.runs[r, 1]
    k = pairs.runs[r, 2]
    s = pairs.runs[r, 3]
    while k % WIDTH:
        k -= 1
        px, pz, pt, pc = _forces(0.0, i + k, j + k, s + k, None, spring, rolls, pairs, motion)
        _add(i + k, px, pz, pt, pc, spring, rolls, motion)
        _add(j + k, -px, -pz, pt, -pc, spring, rolls, motion)
    while k:
        k -= WIDTH
        px, pz, pt, pc = _forces(spread(0.0), i + k, j + k, s + k, None, spring, rolls, pairs, motion)
        _add(i + k, px, pz, pt, pc, spring, rolls, motion)
        _add(j + k, -px, -pz, pt, -pc, spring, rolls, motion)


@kernel
def _add_single_pairs(start, spring, rolls, pairs, motion):
    """Add the forces of the runs of count one, from ``start`` on, several at once; their slots follow one another."""
    runs, scratch = pairs.runs, pairs.scratch
    n, f = motion.n, motion.f
    end = runs.shape[0]
    whole = end - (end - start) % WIDTH
    for r in range(start, whole, WIDTH):
        px, pz, pt, pc = _forces(spread(0.0), r, r, runs[r, 3], runs, spring, rolls, pairs, motion)
        put(scratch, 0, px)
        put(scratch, WIDTH, pz)
        put(scratch, 2 * WIDTH, pt)
        put(scratch, 3 * WIDTH, pc)
        for lane in range(WIDTH):
            i = runs[r + lane, 0]
            j = runs[r + lane, 1]
            f[i] += scratch[lane]
            f[j] -= scratch[lane]
            f[n + i] += scratch[WIDTH + lane]
            f[n + j] -= scratch[WIDTH + lane]
            if spring is not None:
                f[2 * n + i] += scratch[2 * WIDTH + lane]
                f[2 * n + j] += scratch[2 * WIDTH + lane]
            if rolls is not None:
                rolls.couple[i] += scratch[3 * WIDTH + lane]
                rolls.couple[j] -= scratch[3 * WIDTH + lane]
    for r in range(whole, end):
        _add_run(r, spring, rolls, pairs, motion)


# Springs, rims and what rolls are arguments of their own, beside what holds them: only of an argument does the compiler
# know that it is None.
@kernel
def add_pair_forces(spring, rolls, pairs, motion):
    """Add the forces of all disk-disk candidates to those of ``motion``, and their couples to those of ``rolls``.

    ``spring``, ``rolls`` : of ``pairs``; ``pairs``, ``motion`` : ``model.Pairs`` and ``model.Motion``. With friction
    the third part of ``motion.f`` collects the sum of tangential forces, not yet multiplied by ``-radius``.
    """
    for r in range(pairs.runs.shape[0]):
        if pairs.runs[r, 2] == 1:
            _add_single_pairs(r, spring, rolls, pairs, motion)
            break
        _add_run(r, spring, rolls, pairs, motion)


@kernel(forceinline=True)
def _wall_contact(c, walls, motion):
    """Overlap of the disk of wall contact ``c``, and the force were it closed."""
    i, nx, nz = walls.disk[c], walls.normal[c, 0], walls.normal[c, 1]
    overlap = at_wall(motion.q[i], motion.q[motion.n + i], nx, nz, walls.gap[c])
    apart = motion.v[i] * nx + motion.v[motion.n + i] * nz
    return overlap, normal_force(overlap, take(walls.shape, c, 0.0), apart, walls.law)


@kernel
def add_wall_forces(spring, walls, motion):
    """Add the forces of the disk-wall candidates; arguments as in :func:`add_pair_forces`."""
    n, v, f, rim = motion.n, motion.v, motion.f, motion.rim
    for c in range(walls.disk.size):
        i, nx, nz = walls.disk[c], walls.normal[c, 0], walls.normal[c, 1]
        overlap, normal = _wall_contact(c, walls, motion)
        if overlap > 0.0:
            if spring is None:
                fx, fz = frictionless(overlap, nx, nz, normal)
            else:
                slip = v[n + i] * nx - v[i] * nz - rim[i]
                fx, fz, ft, spring[c] = frictional(
                    overlap, nx, nz, normal, slip, spring[c], walls.law, motion.rule, motion.dt
                )  # fmt: skip
                f[2 * n + i] += ft
            f[i] += fx
            f[n + i] += fz
        elif spring is not None:
            spring[c] = 0.0


@kernel
def add_wall_couples(rolls, walls, motion):
    """Add the couples of disks that roll on walls."""
    n = motion.n
    for c in range(walls.disk.size):
        i = walls.disk[c]
        overlap, normal = _wall_contact(c, walls, motion)
        motion.f[2 * n + i] += _couples(overlap, normal, motion.v[2 * n + i], c, rolls, motion.dt)


@kernel
def forces(q, v, f, gravity, load_factor, dt, model):
    """Fill ``f`` with all forces and torques at ``(q, v)``; springs advance by ``dt``."""
    motion = Motion(model.n, q, v, model.rim, f, model.rule, dt)
    _fill(gravity, load_factor, model.rim, model.pairs.rolls, model.walls.rolls, motion, model)


@kernel
def _fill(gravity, load_factor, rim, pair_rolls, wall_rolls, motion, model):
    n, f, pairs, walls = model.n, motion.f, model.pairs, model.walls
    weight = model.weight
    radius = model.radius
    for i in range(n):
        f[i] = 0.0
    for i in range(n):
        f[n + i] = -gravity * weight[i]
    if rim is not None:
        for i in range(n):
            rim[i] = radius[i] * motion.v[2 * n + i]
            f[2 * n + i] = 0.0
    if pair_rolls is not None:
        pair_rolls.couple[:] = 0.0
    add_pair_forces(pairs.spring, pair_rolls, pairs, motion)
    add_wall_forces(walls.spring, walls, motion)
    if rim is not None:
        for i in range(n):
            f[2 * n + i] *= -radius[i]
    if pair_rolls is not None:
        for i in range(n):
            f[2 * n + i] += pair_rolls.couple[i]
    if wall_rolls is not None:
        add_wall_couples(wall_rolls, walls, motion)
    load = model.load
    for c in range(model.load_disk.size):
        i = model.load_disk[c]
        f[i] += load_factor * load[c, 0]
        f[n + i] += load_factor * load[c, 1]
        if rim is not None:
            f[2 * n + i] += load_factor * load[c, 2]
