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

from ..contact.coulomb import limit, moved
from ..contact.geometry import at_wall, between
from ..contact.law import normal_force
from ..contact.pair import frictional, frictional_pair, frictionless, frictionless_pair
from ..machine.lanes import WIDTH, gather, magnitude, put, select, spread, take
from ..machine.machine_code import kernel

#: Pairs of a run of close indices whose forces are held back before they are added to their second disks: memory
#: that one vector has just written at another offset cannot be read again at once.
_BLOCK = 64
#: Length of the scratch that this takes.
SCRATCH = 4 * _BLOCK


@kernel(forceinline=True)
def _shape_at(shape, k, like):
    """What the law needs of the bodies from contact ``k`` on; None for a law that needs nothing."""
    if shape is None:
        return None
    return take(shape, k, like)


@kernel(forceinline=True)
def _rolled(overlap, normal, spin, s, rolls, dt):
    """Couple on the first body of contact ``s``, or of several from there on; springs advance."""
    arm, spring, rolling = take(rolls.arm, s, overlap), take(rolls.spring, s, overlap), rolls.rolling
    most = limit(rolling, magnitude(normal))
    force, new = moved(spring, arm * spin, most, rolling.stiffness, rolling.damping, dt)
    put(rolls.spring, s, select(overlap > 0.0, new, 0.0))
    return select(overlap > 0.0, arm * force, 0.0)


@kernel(forceinline=True)
def _couple(dx, dz, du, dw, reach, form, law, spin, s, rolls, dt):
    """Couple on the first disk of the pair in slot ``s`` that rolls with a relative ``spin``, or of several pairs.

    Springs advance; what is open forgets its own.
    """
    overlap, nx, nz = between(dx, dz, reach)
    normal = normal_force(overlap, form, du * nx + dw * nz, law)
    return _rolled(overlap, normal, spin, s, rolls, dt)


@kernel(forceinline=True)
def _forces_at(like, i, j, s, n, q, v, rim, spring, shape, pairs, rolls, rule, dt):
    """Force on the first disk, its tangential part, and couple, of the pair of disks ``i`` and ``j`` in slot ``s``.

    Or of as many pairs from there on as ``like`` has lanes. Springs advance.
    """
    dx = take(pairs.dx, s, like) + (take(q, i, like) - take(q, j, like))
    dz = take(pairs.dz, s, like) + (take(q, n + i, like) - take(q, n + j, like))
    du = take(v, i, like) - take(v, j, like)
    dw = take(v, n + i, like) - take(v, n + j, like)
    reach = take(pairs.reach, s, like)
    form = _shape_at(shape, s, like)
    if spring is None:
        px, pz = frictionless_pair(dx, dz, du, dw, reach, form, pairs.law)
        return px, pz, like, like
    rims = take(rim, i, like) + take(rim, j, like)
    px, pz, pt, new = frictional_pair(
        dx, dz, du, dw, rims, reach, form, take(spring, s, like), pairs.law, rule, dt
    )  # fmt: skip
    put(spring, s, new)
    if rolls is None:
        return px, pz, pt, like
    spin = take(v, 2 * n + i, like) - take(v, 2 * n + j, like)
    return px, pz, pt, _couple(dx, dz, du, dw, reach, form, pairs.law, spin, s, rolls, dt)


@kernel(forceinline=True)
def _add(f, n, i, px, pz, pt, pc, spring, rolls):
    """Add to the forces on disk ``i``, and the disks after it with lanes."""
    put(f, i, take(f, i, px) + px)
    put(f, n + i, take(f, n + i, pz) + pz)
    if spring is not None:
        put(f, 2 * n + i, take(f, 2 * n + i, pt) + pt)
    if rolls is not None:
        put(rolls.couple, i, take(rolls.couple, i, pc) + pc)


@kernel
def _add_run(r, n, q, v, rim, f, spring, shape, pairs, rolls, rule, dt):
    """Add the forces of run ``r``."""
    i = pairs.runs[r, 0]
    j = pairs.runs[r, 1]
    k = pairs.runs[r, 2]
    s = pairs.runs[r, 3]
    scratch = pairs.scratch
    while k % WIDTH:
        k -= 1
        px, pz, pt, pc = _forces_at(0.0, i + k, j + k, s + k, n, q, v, rim, spring, shape, pairs, rolls, rule, dt)
        _add(f, n, i + k, px, pz, pt, pc, spring, rolls)
        _add(f, n, j + k, -px, -pz, pt, -pc, spring, rolls)
    like = spread(0.0)
    if j - i >= WIDTH:
        while k:
            k -= WIDTH
            px, pz, pt, pc = _forces_at(like, i + k, j + k, s + k, n, q, v, rim, spring, shape, pairs, rolls, rule, dt)
            _add(f, n, i + k, px, pz, pt, pc, spring, rolls)
            _add(f, n, j + k, -px, -pz, pt, -pc, spring, rolls)
        return
    while k:
        end = k
        start = max(k - _BLOCK, 0)
        while k > start:
            k -= WIDTH
            px, pz, pt, pc = _forces_at(like, i + k, j + k, s + k, n, q, v, rim, spring, shape, pairs, rolls, rule, dt)
            _add(f, n, i + k, px, pz, pt, pc, spring, rolls)
            put(scratch, k - start, px)
            put(scratch, _BLOCK + k - start, pz)
            if spring is not None:
                put(scratch, 2 * _BLOCK + k - start, pt)
            if rolls is not None:
                put(scratch, 3 * _BLOCK + k - start, pc)
        while end > start:
            end -= WIDTH
            px = take(scratch, end - start, like)
            pz = take(scratch, _BLOCK + end - start, like)
            pt = take(scratch, 2 * _BLOCK + end - start, like)
            pc = take(scratch, 3 * _BLOCK + end - start, like)
            _add(f, n, j + end, -px, -pz, pt, -pc, spring, rolls)


@kernel
def _add_single_pairs(start, n, q, v, rim, f, spring, shape, pairs, rolls, rule, dt):
    """Add the forces of the runs of count one, from ``start`` on, several at once; their slots follow one another."""
    runs = pairs.runs
    scratch = pairs.scratch
    end = runs.shape[0]
    whole = end - (end - start) % WIDTH
    like = spread(0.0)
    for r in range(start, whole, WIDTH):
        s = runs[r, 3]
        dx = take(pairs.dx, s, like) + (gather(q, 0, runs, r, 0) - gather(q, 0, runs, r, 1))
        dz = take(pairs.dz, s, like) + (gather(q, n, runs, r, 0) - gather(q, n, runs, r, 1))
        du = gather(v, 0, runs, r, 0) - gather(v, 0, runs, r, 1)
        dw = gather(v, n, runs, r, 0) - gather(v, n, runs, r, 1)
        reach = take(pairs.reach, s, like)
        form = _shape_at(shape, s, like)
        if spring is None:
            px, pz = frictionless_pair(dx, dz, du, dw, reach, form, pairs.law)
        else:
            rims = gather(rim, 0, runs, r, 0) + gather(rim, 0, runs, r, 1)
            px, pz, pt, new = frictional_pair(
                dx, dz, du, dw, rims, reach, form, take(spring, s, like), pairs.law, rule, dt
            )  # fmt: skip
            put(spring, s, new)
            put(scratch, 2 * WIDTH, pt)
        if rolls is not None:
            spin = gather(v, 2 * n, runs, r, 0) - gather(v, 2 * n, runs, r, 1)
            put(scratch, 3 * WIDTH, _couple(dx, dz, du, dw, reach, form, pairs.law, spin, s, rolls, dt))
        put(scratch, 0, px)
        put(scratch, WIDTH, pz)
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
        i = runs[r, 0]
        j = runs[r, 1]
        px, pz, pt, pc = _forces_at(0.0, i, j, runs[r, 3], n, q, v, rim, spring, shape, pairs, rolls, rule, dt)
        _add(f, n, i, px, pz, pt, pc, spring, rolls)
        _add(f, n, j, -px, -pz, pt, -pc, spring, rolls)


# Springs, shapes and rolling are arguments of their own, beside what holds them: only of an argument does the compiler
# know that it is None.
@kernel
def add_pair_forces(q, v, rim, f, n, spring, shape, pairs, rolls, rule, dt):
    """Add the forces of all disk-disk candidates to ``f``.

    Parameters
    ----------
    q, v, f : (2 n,) or (3 n,) generalised displacements, velocities, forces. With friction the third part
        of ``f`` collects the sum of tangential forces, not yet multiplied by ``-radius``.
    rim : (n,) radius times angular velocity, or None without friction.
    pairs : ``model.Pairs``, and its ``spring`` and ``shape``; ``rule`` : of ``contact.RULES``; ``dt`` : time step of
        the spring update.
    rolls : ``model.Rolls``, to whose couples is added; None without rolling resistance.
    """
    for r in range(pairs.runs.shape[0]):
        if pairs.runs[r, 2] == 1:
            _add_single_pairs(r, n, q, v, rim, f, spring, shape, pairs, rolls, rule, dt)
            break
        _add_run(r, n, q, v, rim, f, spring, shape, pairs, rolls, rule, dt)


@kernel
def add_wall_forces(q, v, rim, f, n, spring, shape, walls, rule, dt):
    """Add the forces of the disk-wall candidates to ``f``; arguments as in :func:`add_pair_forces`."""
    for c in range(walls.disk.size):
        i = walls.disk[c]
        nx = walls.normal[c, 0]
        nz = walls.normal[c, 1]
        overlap = at_wall(q[i], q[n + i], nx, nz, walls.gap[c])
        form = _shape_at(shape, c, 0.0)
        if overlap > 0.0:
            if spring is None:
                fx, fz = frictionless(overlap, nx, nz, v[i], v[n + i], form, walls.law)
            else:
                fx, fz, ft, spring[c] = frictional(
                    overlap, nx, nz, v[i], v[n + i], rim[i], form, spring[c], walls.law, rule, dt
                )  # fmt: skip
                f[2 * n + i] += ft
            f[i] += fx
            f[n + i] += fz
        elif spring is not None:
            spring[c] = 0.0


@kernel
def add_wall_couples(q, v, f, n, shape, rolls, walls, dt):
    """Add the couples of disks that roll on walls to ``f``; ``rolls`` : ``model.Rolls``."""
    for c in range(walls.disk.size):
        i, nx, nz = walls.disk[c], walls.normal[c, 0], walls.normal[c, 1]
        overlap = at_wall(q[i], q[n + i], nx, nz, walls.gap[c])
        normal = normal_force(overlap, _shape_at(shape, c, 0.0), v[i] * nx + v[n + i] * nz, walls.law)
        f[2 * n + i] += _rolled(overlap, normal, v[2 * n + i], c, rolls, dt)


@kernel
def forces(q, v, f, gravity, load_factor, dt, model):
    """Fill ``f`` with all forces and torques at ``(q, v)``; springs advance by ``dt``."""
    pairs, walls, pair_rolls, wall_rolls = model.pairs, model.walls, model.pair_rolls, model.wall_rolls
    _fill(q, v, f, gravity, load_factor, dt, model.rim, pairs, walls, pair_rolls, wall_rolls, model)


@kernel
def _fill(q, v, f, gravity, load_factor, dt, rim, pairs, walls, pair_rolls, wall_rolls, model):
    n = model.n
    weight = model.weight
    radius = model.radius
    for i in range(n):
        f[i] = 0.0
    for i in range(n):
        f[n + i] = -gravity * weight[i]
    if rim is not None:
        for i in range(n):
            rim[i] = radius[i] * v[2 * n + i]
            f[2 * n + i] = 0.0
    if pair_rolls is not None:
        pair_rolls.couple[:] = 0.0
    add_pair_forces(q, v, rim, f, n, pairs.spring, pairs.shape, pairs, pair_rolls, model.rule, dt)
    add_wall_forces(q, v, rim, f, n, walls.spring, walls.shape, walls, model.rule, dt)
    if rim is not None:
        for i in range(n):
            f[2 * n + i] *= -radius[i]
    if pair_rolls is not None:
        for i in range(n):
            f[2 * n + i] += pair_rolls.couple[i]
    if wall_rolls is not None:
        add_wall_couples(q, v, f, n, walls.shape, wall_rolls, walls, dt)
    load = model.load
    for c in range(model.load_disk.size):
        i = model.load_disk[c]
        f[i] += load_factor * load[c, 0]
        f[n + i] += load_factor * load[c, 1]
        if rim is not None:
            f[2 * n + i] += load_factor * load[c, 2]


@kernel
def accelerations(q, v, a, gravity, load_factor, dt, model):
    """Fill ``a`` with all accelerations; arguments as of :func:`forces`."""
    forces(q, v, a, gravity, load_factor, dt, model)
    inverse_mass = model.inverse_mass
    for k in range(a.size):
        a[k] *= inverse_mass[k]
