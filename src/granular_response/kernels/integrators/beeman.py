"""Beeman's algorithm, the paper's choice (Sec. III)."""

from __future__ import annotations

import numpy as np

from ...machine.lanes import WIDTH, put, spread, take
from ...machine.machine_code import kernel
from ..forces import forces
from .record import LOOK_EVERY, Integrator, goes_on, moved_beyond, ramp


@kernel
def predict(x, v, a, a_before, dt):
    """Displacement after a step, and the velocity predicted for its forces. Scalars or lanes."""
    x = x + (v * dt + (4.0 * a - a_before) * (dt * dt / 6.0))
    return x, v + (3.0 * a - a_before) * (0.5 * dt)


@kernel
def correct(v, a, a_before, a_new, dt):
    """Velocity after a step."""
    return v + (2.0 * a_new + 5.0 * a - a_before) * (dt / 6.0)


@kernel
def _predict(q, v, a, a_before, seen, dt):
    for k in range(q.size):
        q[k], seen[k] = predict(q[k], v[k], a[k], a_before[k], dt)


@kernel(forceinline=True)
def _correct_at(k, like, q, v, a, a_before, force, inverse_mass, seen, dt, predicts):
    a_new = take(force, k, like) * take(inverse_mass, k, like)
    a_now = take(a, k, like)
    v_new = correct(take(v, k, like), a_now, take(a_before, k, like), a_new, dt)
    put(v, k, v_new)
    put(a_before, k, a_now)
    put(a, k, a_new)
    if predicts:
        x, predicted = predict(take(q, k, like), v_new, a_new, a_now, dt)
        put(q, k, x)
        put(seen, k, predicted)


@kernel
def _correct(q, v, a, a_before, force, inverse_mass, seen, dt, predicts):
    """End a step and, where ``predicts``, begin the next while its numbers are at hand."""
    whole = q.size - q.size % WIDTH
    for k in range(0, whole, WIDTH):
        _correct_at(k, spread(0.0), q, v, a, a_before, force, inverse_mass, seen, dt, predicts)
    for k in range(whole, q.size):
        _correct_at(k, 0.0, q, v, a, a_before, force, inverse_mass, seen, dt, predicts)


@kernel(nogil=True)
def advance(steps, dt, schedule, limit, q, v, history, velocity, model):
    """See the package docstring; history rows: a(t), a(t - dt), scratch."""
    time, g0, g1, gt, l0, l1, lt = schedule
    n = model[0]
    inverse_mass = model[2]
    a = history[0]
    a_before = history[1]
    force = history[2]
    begun = False
    for step in range(steps):
        if not begun:
            if limit < np.inf and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
                return step
            _predict(q, v, a, a_before, velocity, dt)
        now = time + (step + 1) * dt
        forces(q, velocity, force, ramp(now, g0, g1, gt), ramp(now, l0, l1, lt), dt, *model)
        begun = goes_on(step + 1, steps, limit)
        _correct(q, v, a, a_before, force, inverse_mass, velocity, dt, begun)
    return steps


def start(q, v, history, dt):
    """No earlier step is known: take the acceleration to have been the same."""
    history[1] = history[0]


def amplification(w2, c, spring_w2=0.0):
    """(5, 5) matrix of one step of length 1 for ``x'' = -w2 x - spring_w2 s - c x'``, ``s' = x'`` (see ``record``)."""

    def step(x, s, v, a, a_before):
        predicted = v + (3.0 * a - a_before) / 2.0
        x = x + v + (4.0 * a - a_before) / 6.0
        s = s + predicted
        a_new = -w2 * x - spring_w2 * s - c * predicted
        return x, s, v + (2.0 * a_new + 5.0 * a - a_before) / 6.0, a_new, a

    return np.array([step(*unit) for unit in np.eye(5)]).T


RECORD = Integrator(
    name="beeman",
    title="Beeman",
    order=2,
    rows=3,
    reference="D. Beeman, J. Comput. Phys. 20, 130 (1976); the paper, Sec. III",
    advance=advance,
    start=start,
    amplification=amplification,
)
