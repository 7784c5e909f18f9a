"""Velocity Verlet with a full-step predicted velocity for the dashpots."""

from __future__ import annotations

import numpy as np

from ...machine.lanes import WIDTH, put, spread, take
from ...machine.machine_code import kernel
from ..forces import forces
from .record import LOOK_EVERY, Integrator, goes_on, moved_beyond, ramp


@kernel
def drift(x, v, a, dt):
    """Displacement after a step, and the velocity predicted for its forces. Scalars or lanes."""
    return x + (v * dt + a * (0.5 * dt * dt)), v + a * dt


@kernel
def kick(v, a, a_new, dt):
    """Velocity after a step."""
    return v + (a + a_new) * (0.5 * dt)


@kernel
def _drift(q, v, a, seen, dt):
    for k in range(q.size):
        q[k], seen[k] = drift(q[k], v[k], a[k], dt)


@kernel(forceinline=True)
def _kick_at(k, like, q, v, a, force, inverse_mass, seen, dt, drifts):
    a_new = take(force, k, like) * take(inverse_mass, k, like)
    v_new = kick(take(v, k, like), take(a, k, like), a_new, dt)
    put(v, k, v_new)
    put(a, k, a_new)
    if drifts:
        x, predicted = drift(take(q, k, like), v_new, a_new, dt)
        put(q, k, x)
        put(seen, k, predicted)


@kernel
def _kick(q, v, a, force, inverse_mass, seen, dt, drifts):
    """End a step and, where ``drifts``, begin the next while its numbers are at hand."""
    whole = q.size - q.size % WIDTH
    for k in range(0, whole, WIDTH):
        _kick_at(k, spread(0.0), q, v, a, force, inverse_mass, seen, dt, drifts)
    for k in range(whole, q.size):
        _kick_at(k, 0.0, q, v, a, force, inverse_mass, seen, dt, drifts)


@kernel(nogil=True)
def advance(steps, dt, schedule, limit, q, v, history, velocity, model):
    """See the package docstring; history rows: a(t), scratch."""
    time, g0, g1, gt, l0, l1, lt = schedule
    n = model[0]
    inverse_mass = model[2]
    a = history[0]
    force = history[1]
    begun = False
    for step in range(steps):
        if not begun:
            if limit < np.inf and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
                return step
            _drift(q, v, a, velocity, dt)
        now = time + (step + 1) * dt
        forces(q, velocity, force, ramp(now, g0, g1, gt), ramp(now, l0, l1, lt), dt, *model)
        begun = goes_on(step + 1, steps, limit)
        _kick(q, v, a, force, inverse_mass, velocity, dt, begun)
    return steps


def start(q, v, history, dt):
    """Needs nothing beyond the present acceleration."""


def amplification(w2, c, spring_w2=0.0):
    """(4, 4) matrix of one step of length 1 for ``x'' = -w2 x - spring_w2 s - c x'``, ``s' = x'`` (see ``record``)."""

    def step(x, s, v, a):
        predicted = v + a
        x = x + v + a / 2.0
        s = s + predicted
        a_new = -w2 * x - spring_w2 * s - c * predicted
        return x, s, v + (a + a_new) / 2.0, a_new

    return np.array([step(*unit) for unit in np.eye(4)]).T


RECORD = Integrator(
    name="verlet",
    title="velocity Verlet",
    order=2,
    rows=2,
    reference="W. C. Swope et al., J. Chem. Phys. 76, 637 (1982)",
    advance=advance,
    start=start,
    amplification=amplification,
)
