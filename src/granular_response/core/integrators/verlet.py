"""Velocity Verlet with a full-step predicted velocity for the dashpots."""

from __future__ import annotations

import numba as nb
import numpy as np

from ..forces import accelerations
from .record import LOOK_EVERY, Integrator, moved_beyond, ramp


@nb.njit(cache=True, error_model="numpy")
def drift(x, v, a, dt):
    """Displacement after a step, and the velocity predicted for its forces. Scalars or lanes."""
    return x + (v * dt + a * (0.5 * dt * dt)), v + a * dt


@nb.njit(cache=True, error_model="numpy")
def kick(v, a, a_new, dt):
    """Velocity after a step."""
    return v + (a + a_new) * (0.5 * dt)


@nb.njit(cache=True, error_model="numpy")
def _drift(q, v, a, predicted, dt):
    for k in range(q.size):
        q[k], predicted[k] = drift(q[k], v[k], a[k], dt)


@nb.njit(cache=True, error_model="numpy")
def _kick(v, a, a_new, dt):
    for k in range(v.size):
        v[k] = kick(v[k], a[k], a_new[k], dt)
        a[k] = a_new[k]


@nb.njit(cache=True, error_model="numpy", nogil=True)
def advance(steps, dt, schedule, limit, q, v, history, velocity, model):
    """See the package docstring; history rows: a(t), scratch."""
    time, g0, g1, gt, l0, l1, lt = schedule
    n = model[0]
    a = history[0]
    a_new = history[1]
    for step in range(steps):
        if step % LOOK_EVERY == 0 and limit < np.inf and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
            return step
        _drift(q, v, a, velocity, dt)
        now = time + (step + 1) * dt
        accelerations(q, velocity, a_new, ramp(now, g0, g1, gt), ramp(now, l0, l1, lt), dt, *model)
        _kick(v, a, a_new, dt)
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
