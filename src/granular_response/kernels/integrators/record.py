"""What an integrator says of itself, and what all integrators share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from ...machine.lanes import WIDTH, anywhere, magnitude, spread, take
from ...machine.machine_code import kernel

#: Steps between two looks at how far disks have moved.
LOOK_EVERY = 8


@dataclass(frozen=True)
class Integrator:
    """One time integrator.

    ``rows`` is the number of history rows, ``order`` the global order of its positions on a smooth problem once
    its history is known (Gear's start without higher derivatives costs it two orders),
    ``start(q, v, history, dt)`` fills the history from its row 0. ``amplification(w2, c, spring_w2)`` is the matrix
    of one step of length 1 for a damped oscillator with two springs, ``x'' = -w2 x - spring_w2 s - c x'``: the first
    follows the position, as overlaps do, and ``s`` is advanced by the predicted velocity, as the tangential springs
    are. The step is stable while no eigenvalue exceeds 1.
    """

    name: str
    title: str
    order: int
    rows: int
    reference: str
    advance: Callable
    start: Callable
    amplification: Callable


@kernel
def ramp(time, start, end, duration):
    """Linear ramp from ``start`` at time 0 to ``end`` at ``duration``, constant after."""
    if time >= duration:
        return end
    return start + (end - start) * (time / duration)


@kernel
def goes_on(step, steps, limit):
    """Whether step number ``step`` follows at once: there is one, and no look at the disks comes before it."""
    return step < steps and (step % LOOK_EVERY != 0 or not limit < math.inf)


@kernel
def _beyond(q, v, n, limit, horizon, start, end):
    for i in range(start, end):
        reach = math.sqrt(q[i] * q[i] + q[n + i] * q[n + i])
        reach += horizon * math.sqrt(v[i] * v[i] + v[n + i] * v[n + i])
        if reach > limit:
            return True
    return False


@kernel
def moved_beyond(q, v, n, limit, horizon):
    """Whether a disk may be farther than ``limit`` from its reference position within ``horizon``.

    Most disks are far from that, which sums of components show without a root.
    """
    whole = n - n % WIDTH
    like = spread(0.0)
    for k in range(0, whole, WIDTH):
        reach = magnitude(take(q, k, like)) + magnitude(take(q, n + k, like))
        speed = magnitude(take(v, k, like)) + magnitude(take(v, n + k, like))
        if anywhere(reach + horizon * speed > limit) and _beyond(q, v, n, limit, horizon, k, k + WIDTH):
            return True
    return _beyond(q, v, n, limit, horizon, whole, n)
