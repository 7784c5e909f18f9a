"""The loop over time steps that all integrators share, and what a step does to an oscillator.

An integrator is a named tuple with two methods on scalars or lanes. ``predict(x, v, a, b, c, dt)`` gives
``(x, v, a, b, seen)``: the displacement at which forces are evaluated, velocity and memory there, and the velocity that
the forces see. ``correct(x, v, a, b, c, a_new, dt)`` gives ``(x, v, a, b, c)`` at the end from the accelerations there.
``a`` is the acceleration at the present time, ``b`` and ``c`` are memory of its own: it has ``rows`` rows with ``a``.
``order`` is the global order of its positions on a smooth problem once its memory is right (Gear's start without
higher derivatives costs it two orders). ``begin(history)`` fills (rows, dof) memory from its row 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ...machine.lanes import WIDTH, anywhere, magnitude, put, root, spread, take
from ...machine.machine_code import by_type, kernel
from ..forces import forces

#: Steps between two looks at how far disks have moved.
LOOK_EVERY = 8


class Integrator(Protocol):
    """One time integrator; see the module."""

    def predict(self, x, v, a, b, c, dt): ...
    def correct(self, x, v, a, b, c, a_new, dt): ...
    def begin(self, history: NDArray) -> None: ...

    @property
    def rows(self) -> int: ...
    @property
    def order(self) -> int: ...


def lead(integrator: Integrator) -> float:
    """Time by which tangential springs are ahead of displacements, in time steps.

    They follow the velocity that forces see, which most integrators predict for the end of a step, while a displacement
    goes with the velocity in its middle: from rest under a constant acceleration the two differ by this.
    """
    history = np.array([[1.0], [0.0], [0.0]])
    integrator.begin(history)
    a, b, c = history[:, 0].tolist()
    x, _, _, _, seen = integrator.predict(0.0, 0.0, a, b, c, 1.0)
    return seen - x


class Memory(NamedTuple):
    """Rows (dof,) that an integrator keeps from step to step, and scratch for forces and the velocity that they see."""

    a: NDArray[Any]
    b: NDArray[Any] | None
    c: NDArray[Any] | None
    force: NDArray[Any]
    seen: NDArray[Any]


@by_type
def predict(self, x, v, a, b, c, dt):
    """First half of a step; see the module."""


@by_type
def correct(self, x, v, a, b, c, a_new, dt):
    """Second half of a step; see the module."""


#: Of a step the first half, the second half, or the second half of one and the first half of the next. Of constants of
#: Python the compiler would make a version each of what they are given to.
FIRST, SECOND, BOTH = np.int64(0), np.int64(1), np.int64(2)


@kernel(forceinline=True)
def _turn_at(k, like, integrator, halves, q, v, memory, inverse_mass, dt):
    a, b, c = memory.a, memory.b, memory.c
    x, u, w, y, z = take(q, k, like), take(v, k, like), take(a, k, like), take(b, k, like), take(c, k, like)
    if halves != FIRST:
        a_new = take(memory.force, k, like) * take(inverse_mass, k, like)
        x, u, w, y, z = correct(integrator, x, u, w, y, z, a_new, dt)
    if halves != SECOND:
        x, u, w, y, s = predict(integrator, x, u, w, y, z, dt)
        put(memory.seen, k, s)
    put(q, k, x)
    put(v, k, u)
    put(a, k, w)
    put(b, k, y)
    put(c, k, z)


@kernel
def _turn(integrator, halves, q, v, memory, inverse_mass, dt):
    """Do the ``halves`` of steps: FIRST, SECOND or BOTH."""
    whole = q.size - q.size % WIDTH
    for k in range(0, whole, WIDTH):
        _turn_at(k, spread(0.0), integrator, halves, q, v, memory, inverse_mass, dt)
    for k in range(whole, q.size):
        _turn_at(k, 0.0, integrator, halves, q, v, memory, inverse_mass, dt)


@kernel(nogil=True)
def advance(integrator, steps, dt, schedule, limit, q, v, memory, model, taken=0):
    """Take up to ``steps`` steps of ``dt``; returns how many were taken.

    Fewer when a disk has moved so far that the candidate contacts must be listed again: ``limit`` is the displacement
    that ends the validity of the list (``inf``: never checked). ``schedule`` : ``model.Schedule``; ``q``, ``v`` :
    displacements and velocities; ``memory`` : :class:`Memory`; ``model`` : ``model.Model``. ``taken`` : steps since
    ``schedule.time``: with it disks are looked at before the same steps wherever a motion is cut.
    """
    n = model.n
    inverse_mass = model.inverse_mass
    begun = False
    for step in range(steps):
        if not begun:
            look = (taken + step) % LOOK_EVERY == 0 and limit < np.inf
            if look and moved_beyond(q, v, n, limit, dt * LOOK_EVERY):
                return step
            _turn(integrator, FIRST, q, v, memory, inverse_mass, dt)
        done = taken + step + 1
        now = schedule.time + done * dt
        gravity = ramp(now, schedule.gravity_from, schedule.gravity_to, schedule.gravity_time)
        load = ramp(now, schedule.load_from, schedule.load_to, schedule.load_time)
        forces(q, memory.seen, memory.force, gravity, load, dt, model)
        # whether the next one follows at once: there is one, and no look at the disks comes before it
        begun = step + 1 < steps and (done % LOOK_EVERY != 0 or not limit < np.inf)
        _turn(integrator, BOTH if begun else SECOND, q, v, memory, inverse_mass, dt)
    return steps


def amplification(integrator: Integrator, w2: float, c: float, spring_w2: float = 0.0) -> NDArray[np.float64]:
    """(6, 6) matrix of one step of length 1 for ``x'' = -w2 x - spring_w2 s - c x'``.

    The first spring follows the position, as overlaps do, and ``s`` is advanced by the predicted velocity, as the
    tangential springs are. The step is stable while no eigenvalue exceeds 1. Memory that an integrator does not have
    gives zero eigenvalues.
    """

    def step(x, s, v, a, b, d):
        x, v, a, b, seen = integrator.predict(x, v, a, b, d, 1.0)
        s = s + seen
        x, v, a, b, d = integrator.correct(x, v, a, b, d, -w2 * x - spring_w2 * s - c * seen, 1.0)
        return x, s, v, a, b, d

    memory = np.eye(6)
    memory[3 + integrator.rows :] = 0.0
    return np.array([step(*unit) for unit in memory]).T


@kernel
def ramp(time, start, end, duration):
    """Linear ramp from ``start`` at time 0 to ``end`` at ``duration``, constant after."""
    if time >= duration:
        return end
    return start + (end - start) * (time / duration)


@kernel(forceinline=True)
def _beyond(k, like, q, v, n, limit, horizon):
    x, z, u, w = take(q, k, like), take(q, n + k, like), take(v, k, like), take(v, n + k, like)
    # most disks are far from that, which sums of components show without a root
    if not anywhere(magnitude(x) + magnitude(z) + horizon * (magnitude(u) + magnitude(w)) > limit):
        return False
    return anywhere(root(x * x + z * z) + horizon * root(u * u + w * w) > limit)


@kernel
def moved_beyond(q, v, n, limit, horizon):
    """Whether a disk may be farther than ``limit`` from its reference position within ``horizon``."""
    whole = n - n % WIDTH
    beyond = False
    for k in range(0, whole, WIDTH):
        beyond |= _beyond(k, spread(0.0), q, v, n, limit, horizon)
    for k in range(whole, n):
        beyond |= _beyond(k, 0.0, q, v, n, limit, horizon)
    return beyond
