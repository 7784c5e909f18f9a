"""Gear's 5-value predictor-corrector, the paper's check of its integrator (Sec. III)."""

from __future__ import annotations

import numpy as np

from ...machine.lanes import WIDTH, put, spread, take
from ...machine.machine_code import kernel
from ..forces import forces
from .record import LOOK_EVERY, Integrator, goes_on, moved_beyond, ramp

# Corrector coefficients for second-order equations whose forces depend on velocity
# (Allen & Tildesley, Computer Simulation of Liquids, App. E).
_C0, _C1, _C3, _C4 = 19.0 / 90.0, 3.0 / 4.0, 1.0 / 2.0, 1.0 / 12.0


@kernel
def predict(x, v, a, b, c, dt):
    """Taylor series of displacement and its first three derivatives; ``c`` is the fourth. Scalars or lanes."""
    h2 = dt * dt / 2.0
    h3 = h2 * dt / 3.0
    h4 = h3 * dt / 4.0
    x = x + (v * dt + a * h2 + b * h3 + c * h4)
    v = v + (a * dt + b * h2 + c * h3)
    a = a + (b * dt + c * h2)
    return x, v, a, b + c * dt


@kernel
def correct(x, v, a, b, c, a_new, dt):
    """Displacement, velocity, third and fourth derivative for the new acceleration."""
    change = a_new - a
    x = x + _C0 * dt * dt / 2.0 * change
    v = v + _C1 * dt / 2.0 * change
    return x, v, b + _C3 * 3.0 / dt * change, c + _C4 * 12.0 / (dt * dt) * change


@kernel
def _predict(q, v, a, b, c, dt):
    for k in range(q.size):
        q[k], v[k], a[k], b[k] = predict(q[k], v[k], a[k], b[k], c[k], dt)


@kernel(forceinline=True)
def _correct_at(k, like, q, v, a, b, c, force, inverse_mass, dt, predicts):
    a_new = take(force, k, like) * take(inverse_mass, k, like)
    x, v_new, b_new, c_new = correct(
        take(q, k, like), take(v, k, like), take(a, k, like), take(b, k, like), take(c, k, like), a_new, dt
    )
    if predicts:
        x, v_new, a_new, b_new = predict(x, v_new, a_new, b_new, c_new, dt)
    put(q, k, x)
    put(v, k, v_new)
    put(a, k, a_new)
    put(b, k, b_new)
    put(c, k, c_new)


@kernel
def _correct(q, v, a, b, c, force, inverse_mass, dt, predicts):
    """End a step and, where ``predicts``, begin the next while its numbers are at hand."""
    whole = q.size - q.size % WIDTH
    for k in range(0, whole, WIDTH):
        _correct_at(k, spread(0.0), q, v, a, b, c, force, inverse_mass, dt, predicts)
    for k in range(whole, q.size):
        _correct_at(k, 0.0, q, v, a, b, c, force, inverse_mass, dt, predicts)


@kernel(nogil=True)
def advance(steps, dt, schedule, limit, q, v, history, velocity, model):
    """See the package docstring; history rows: second, third and fourth derivative, scratch."""
    time, g0, g1, gt, l0, l1, lt = schedule
    n = model[0]
    inverse_mass = model[2]
    a = history[0]
    b = history[1]
    c = history[2]
    force = history[3]
    begun = False
    for step in range(steps):
        if not begun:
            if limit < np.inf and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
                return step
            _predict(q, v, a, b, c, dt)
        now = time + (step + 1) * dt
        forces(q, v, force, ramp(now, g0, g1, gt), ramp(now, l0, l1, lt), dt, *model)
        begun = goes_on(step + 1, steps, limit)
        _correct(q, v, a, b, c, force, inverse_mass, dt, begun)
    return steps


def start(q, v, history, dt):
    """Third and fourth derivatives are unknown at the start and settle within a few steps."""
    history[1:3] = 0.0


def amplification(w2, c, spring_w2=0.0):
    """(6, 6) matrix of one step of length 1 for ``x'' = -w2 x - spring_w2 s - c x'``, ``s' = x'`` (see ``record``)."""

    def step(x, s, v, a, b, d):
        x = x + v + a / 2.0 + b / 6.0 + d / 24.0
        v = v + a + b / 2.0 + d / 6.0
        a = a + b + d / 2.0
        b = b + d
        s = s + v
        a_new = -w2 * x - spring_w2 * s - c * v
        change = a_new - a
        x = x + 0.5 * _C0 * change
        return x, s, v + 0.5 * _C1 * change, a_new, b + 3.0 * _C3 * change, d + 12.0 * _C4 * change

    return np.array([step(*unit) for unit in np.eye(6)]).T


RECORD = Integrator(
    name="gear",
    title="Gear 5-value predictor-corrector",
    order=4,
    rows=4,
    reference="C. W. Gear, Argonne report ANL-7126 (1966); the paper, Sec. III",
    advance=advance,
    start=start,
    amplification=amplification,
)
