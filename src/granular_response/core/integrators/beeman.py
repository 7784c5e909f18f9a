"""Beeman's algorithm, the paper's choice (Sec. III)."""

from __future__ import annotations

import numba as nb
import numpy as np

from ..forces import accelerations
from .record import LOOK_EVERY, Integrator, moved_beyond, ramp


@nb.njit(cache=True, error_model="numpy")
def predict(x, v, a, a_before, dt):
    """Displacement after a step, and the velocity predicted for its forces. Scalars or lanes."""
    x = x + (v * dt + (4.0 * a - a_before) * (dt * dt / 6.0))
    return x, v + (3.0 * a - a_before) * (0.5 * dt)


@nb.njit(cache=True, error_model="numpy")
def correct(v, a, a_before, a_new, dt):
    """Velocity after a step."""
    return v + (2.0 * a_new + 5.0 * a - a_before) * (dt / 6.0)


@nb.njit(cache=True, error_model="numpy")
def _predict(q, v, a, a_before, predicted, dt):
    for k in range(q.size):
        q[k], predicted[k] = predict(q[k], v[k], a[k], a_before[k], dt)


@nb.njit(cache=True, error_model="numpy")
def _correct(v, a, a_before, a_new, dt):
    for k in range(v.size):
        v[k] = correct(v[k], a[k], a_before[k], a_new[k], dt)
        a_before[k] = a[k]
        a[k] = a_new[k]


@nb.njit(cache=True, error_model="numpy", nogil=True)
def advance(steps, dt, schedule, limit, q, v, history, velocity, model):
    """See the package docstring; history rows: a(t), a(t - dt), scratch."""
    time, g0, g1, gt, l0, l1, lt = schedule
    n = model[0]
    a = history[0]
    a_before = history[1]
    a_new = history[2]
    for step in range(steps):
        if step % LOOK_EVERY == 0 and limit < np.inf and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
            return step
        _predict(q, v, a, a_before, velocity, dt)
        now = time + (step + 1) * dt
        accelerations(q, velocity, a_new, ramp(now, g0, g1, gt), ramp(now, l0, l1, lt), dt, *model)
        _correct(v, a, a_before, a_new, dt)
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
