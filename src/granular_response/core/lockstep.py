"""Several scenes in lock-step: one sweep over the disks advances ``WIDTH`` scenes with the same candidate contacts.

Every lane (see ``core.lanes``) is a scene of its own, with its own clock, step length, ramps, radii, masses, law and
springs; the scenes share who may touch whom, and nothing else. Each lane goes through the operations of the
single-scene integrators in the same order, so its motion is the same to the last bit, whatever the other
lanes do.

A time step is one sweep over the disks in their order, in chunks. The forces of the candidate pairs whose first disk
is in the chunk are found; those of its disks' other pairs are known from earlier chunks, and no later pair looks at
its disks. So they are advanced to the next step at once, while they are at hand.

Arrays have a row of lanes for each quantity of each entry; :func:`advance` describes them all.
"""

from __future__ import annotations

import math

import numba as nb

from .integrators import beeman, gear, verlet
from .lanes import load, select, spread, store
from .law import LITERAL, normal_force, tangential_cut, tangential_literal
from .pair import frictional_pair, frictionless_pair

#: Integrators by number, as :func:`advance` takes them.
KINDS = {"beeman": 0, "verlet": 1, "gear": 2}
_BEEMAN, _VERLET = KINDS["beeman"], KINDS["verlet"]
#: Rows of ``motion`` for each component of a disk: see the module docstring.
FIELDS = 6
_SEEN, _VELOCITY, _A, _B, _C = range(1, FIELDS)
#: Rows of ``disk``, ``contact``, ``force``, ``wall``, ``loads`` for each entry.
DISK, CONTACT, FORCE, WALL, LOAD = 4, 4, 3, 2, 3
#: Disks whose pairs are dealt with before they are advanced: enough for loops to run, few enough to stay at hand.
CHUNK = 32


@nb.njit(cache=True, error_model="numpy")
def _law(laws, which):
    k = 6 * which
    return load(laws, k), load(laws, k + 1), load(laws, k + 2), load(laws, k + 3), load(laws, k + 4), load(laws, k + 5)


@nb.njit(cache=True, error_model="numpy")
def _ramp(time, start, end, duration):
    """``integrators.record.ramp`` for lanes."""
    return select(time >= duration, end, start + (end - start) * (time / duration))


@nb.njit(cache=True, error_model="numpy")
def _frictionless_pairs(start, end, motion, rows, contact, force, first, second, law):
    """Forces of the candidates ``start:end``."""
    c = rows // FIELDS
    for k in range(start, end):
        i = rows * first[k]
        j = rows * second[k]
        p = CONTACT * k
        dx = load(contact, p) + (load(motion, i) - load(motion, j))
        dz = load(contact, p + 1) + (load(motion, i + 1) - load(motion, j + 1))
        du = load(motion, i + c) - load(motion, j + c)
        dw = load(motion, i + c + 1) - load(motion, j + c + 1)
        fx, fz = frictionless_pair(dx, dz, du, dw, load(contact, p + 2), law)
        store(force, FORCE * k, fx)
        store(force, FORCE * k + 1, fz)


@nb.njit(cache=True, error_model="numpy")
def _frictional_pairs(start, end, motion, contact, force, first, second, law, rule, dt):
    """Forces of the candidates ``start:end``; their springs advance."""
    for k in range(start, end):
        i = 3 * FIELDS * first[k]
        j = 3 * FIELDS * second[k]
        p = CONTACT * k
        dx = load(contact, p) + (load(motion, i) - load(motion, j))
        dz = load(contact, p + 1) + (load(motion, i + 1) - load(motion, j + 1))
        du = load(motion, i + 3) - load(motion, j + 3)
        dw = load(motion, i + 4) - load(motion, j + 4)
        rims = load(motion, i + 5) + load(motion, j + 5)
        spring = load(contact, p + 3)
        fx, fz, ft, spring = frictional_pair(dx, dz, du, dw, rims, load(contact, p + 2), spring, law, rule, dt)
        store(contact, p + 3, spring)
        store(force, FORCE * k, fx)
        store(force, FORCE * k + 1, fz)
        store(force, FORCE * k + 2, ft)


@nb.njit(cache=True, error_model="numpy")
def _advance_component(motion, row, c, acceleration, dt, kind, rim, more):
    """Correct a component of a disk for the new acceleration and, if there are ``more``, predict its next step.

    ``row`` : of its displacement; ``rim`` multiplies the velocity that contacts see.
    """
    x = load(motion, row)
    v = load(motion, row + _VELOCITY * c)
    a = load(motion, row + _A * c)
    if kind == _VERLET:
        v = verlet.kick(v, a, acceleration, dt)
        if more:
            x, seen = verlet.drift(x, v, acceleration, dt)
            store(motion, row, x)
            store(motion, row + _SEEN * c, rim * seen)
        store(motion, row + _A * c, acceleration)
    elif kind == _BEEMAN:
        v = beeman.correct(v, a, load(motion, row + _B * c), acceleration, dt)
        if more:
            x, seen = beeman.predict(x, v, acceleration, a, dt)
            store(motion, row, x)
            store(motion, row + _SEEN * c, rim * seen)
        store(motion, row + _A * c, acceleration)
        store(motion, row + _B * c, a)
    else:
        x, v, b, d = gear.correct(x, v, a, load(motion, row + _B * c), load(motion, row + _C * c), acceleration, dt)
        a = acceleration
        if more:
            x, v, a, b = gear.predict(x, v, a, b, d, dt)
            store(motion, row + _SEEN * c, rim * v)
        store(motion, row, x)
        store(motion, row + _A * c, a)
        store(motion, row + _B * c, b)
        store(motion, row + _C * c, d)
    store(motion, row + _VELOCITY * c, v)


@nb.njit(cache=True, error_model="numpy")
def _predict_component(motion, row, c, dt, kind, rim):
    """The first prediction of :func:`advance`."""
    x = load(motion, row)
    v = load(motion, row + _VELOCITY * c)
    a = load(motion, row + _A * c)
    if kind == _VERLET:
        x, seen = verlet.drift(x, v, a, dt)
    elif kind == _BEEMAN:
        x, seen = beeman.predict(x, v, a, load(motion, row + _B * c), dt)
    else:
        x, seen, a, b = gear.predict(x, v, a, load(motion, row + _B * c), load(motion, row + _C * c), dt)
        store(motion, row + _VELOCITY * c, seen)
        store(motion, row + _A * c, a)
        store(motion, row + _B * c, b)
    store(motion, row, x)
    store(motion, row + _SEEN * c, rim * seen)


@nb.njit(cache=True, error_model="numpy", forceinline=True)
def _advance_disk(
    i, more, gravity, load_factor, dt, kind, rule, pair_friction, wall_friction, rotations,
    motion, disk, force, wall, loads, law,
    term_start, term, wall_start, wall_normal, load_start,
):  # fmt: skip
    """Sum the forces of disk ``i`` in the order of ``core.forces``, and integrate."""
    c = 2 if rotations is None else 3
    row = FIELDS * c * i
    fx = spread(0.0)
    fz = -gravity * load(disk, DISK * i)
    ft = spread(0.0)
    for t in range(term_start[i], term_start[i + 1]):
        k = term[t]
        if k >= 0:  # this disk is the pair's first
            fx = fx + load(force, FORCE * k)
            fz = fz + load(force, FORCE * k + 1)
        else:
            k = ~k
            fx = fx - load(force, FORCE * k)
            fz = fz - load(force, FORCE * k + 1)
        if rotations is not None and pair_friction:
            ft = ft + load(force, FORCE * k + 2)
    for k in range(wall_start[i], wall_start[i + 1]):
        nx = wall_normal[k, 0]
        nz = wall_normal[k, 1]
        overlap = -(load(wall, WALL * k) + load(motion, row) * nx + load(motion, row + 1) * nz)
        closed = overlap > 0.0
        u = load(motion, row + c)
        w = load(motion, row + c + 1)
        fn = normal_force(overlap, u * nx + w * nz, law)
        fn_closed = select(closed, fn, 0.0)
        fx = fx + fn_closed * nx
        fz = fz + fn_closed * nz
        if rotations is not None and wall_friction:
            slip = w * nx - u * nz - load(motion, row + c + 2)
            spring = load(wall, WALL * k + 1)
            if rule == LITERAL:
                f, new = tangential_literal(spring, slip, fn, law, dt)
            else:
                f, new = tangential_cut(spring, slip, fn, law, dt)
            f = select(closed, f, 0.0)
            store(wall, WALL * k + 1, select(closed, new, 0.0))
            fx = fx - f * nz
            fz = fz + f * nx
            ft = ft + f
    radius = load(disk, DISK * i + 1)
    ft = ft * -radius
    for k in range(load_start[i], load_start[i + 1]):
        fx = fx + load_factor * load(loads, LOAD * k)
        fz = fz + load_factor * load(loads, LOAD * k + 1)
        ft = ft + load_factor * load(loads, LOAD * k + 2)
    inverse_mass = load(disk, DISK * i + 2)
    one = spread(1.0)
    _advance_component(motion, row, c, fx * inverse_mass, dt, kind, one, more)
    _advance_component(motion, row + 1, c, fz * inverse_mass, dt, kind, one, more)
    if rotations is not None:
        _advance_component(motion, row + 2, c, ft * load(disk, DISK * i + 3), dt, kind, radius, more)


@nb.njit(cache=True, error_model="numpy")
def moved_beyond(motion, c, limit, horizon, found):
    """Per lane: whether a disk may be farther than ``limit`` from its reference position within ``horizon``.

    ``motion`` as of ``advance``; ``limit``, ``horizon``, ``found`` : (lanes,). As ``integrators.record.moved_beyond``.
    """
    rows = FIELDS * c
    for lane in range(limit.size):
        found[lane] = False
        for i in range(motion.shape[0] // rows):
            x, z = motion[rows * i, lane], motion[rows * i + 1, lane]
            vx, vz = motion[rows * i + 2 * c, lane], motion[rows * i + 2 * c + 1, lane]
            if math.sqrt(x * x + z * z) + horizon[lane] * math.sqrt(vx * vx + vz * vz) > limit[lane]:
                found[lane] = True
                break


@nb.njit(cache=True, error_model="numpy", nogil=True)
def advance(
    steps, done, kind, rule, pair_friction, wall_friction, rotations, clock,
    motion, disk, contact, force, wall, loads, laws,
    pair_start, pair_first, pair_second, term_start, term, wall_start, wall_normal, load_start,
):  # fmt: skip
    """Advance all lanes by ``steps`` time steps.

    Parameters
    ----------
    done : steps made since the clock was set.
    kind : integrator, see ``KINDS``; ``rule`` : CUT or LITERAL; ``pair_friction``, ``wall_friction`` : bool;
        ``rotations`` : None without them, which leaves them out at compile time.
    clock : (8, lanes) time now, time step, and the linear ramps of gravity and load: from, to, duration. The time
        is left as it is.
    motion : (FIELDS c n, lanes) for each disk FIELDS blocks of ``c`` components (x, z, and the angle with rotations):
        displacements; what its contacts see of its velocity (the rim's speed in place of the angular velocity);
        velocities; three rows of the integrator's history.
    disk : (DISK n, lanes) weight, radius, inverse mass, inverse moment of inertia.
    contact : (CONTACT m, lanes) reference separation x and z, sum of radii, tangential spring of each candidate.
    force : (FORCE m, lanes) scratch: force x and z on the first disk, tangential force.
    wall : (WALL w, lanes) reference gap and tangential spring of each disk-wall candidate.
    loads : (LOAD l, lanes) force and torque at load factor 1; ``laws`` : (12, lanes) law of pairs and of walls.
    pair_start : (n + 1,) the pairs with first disk ``i`` are ``pair_start[i]:pair_start[i + 1]``; ``pair_first``,
        ``pair_second`` : (m,) their disks.
    term_start : (n + 1,); ``term`` : (2 m,) the pairs of each disk in the order in which their forces are added:
        ``k`` where the disk is the first of pair ``k`` and ``~k`` where it is the second.
    wall_start, load_start : (n + 1,) like ``pair_start``; ``wall_normal`` : (w, 2) inward normals.
    """
    n = pair_start.size - 1
    c = 2 if rotations is None else 3
    rows = FIELDS * c
    time = load(clock, 0)
    dt = load(clock, 1)
    pair_law = _law(laws, 0)
    wall_law = _law(laws, 1)
    one = spread(1.0)
    for i in range(n):
        _predict_component(motion, rows * i, c, dt, kind, one)
        _predict_component(motion, rows * i + 1, c, dt, kind, one)
        if rotations is not None:
            _predict_component(motion, rows * i + 2, c, dt, kind, load(disk, DISK * i + 1))
    for step in range(steps):
        now = time + float(done + step + 1) * dt
        gravity = _ramp(now, load(clock, 2), load(clock, 3), load(clock, 4))
        load_factor = _ramp(now, load(clock, 5), load(clock, 6), load(clock, 7))
        for chunk in range(0, n, CHUNK):
            end = min(chunk + CHUNK, n)
            pairs = pair_start[chunk], pair_start[end]
            if rotations is not None and pair_friction:
                _frictional_pairs(*pairs, motion, contact, force, pair_first, pair_second, pair_law, rule, dt)
            else:
                _frictionless_pairs(*pairs, motion, rows, contact, force, pair_first, pair_second, pair_law)
            for i in range(chunk, end):
                _advance_disk(
                    i, step + 1 < steps, gravity, load_factor, dt, kind, rule,
                    pair_friction, wall_friction, rotations, motion, disk, force, wall, loads, wall_law,
                    term_start, term, wall_start, wall_normal, load_start,
                )  # fmt: skip
