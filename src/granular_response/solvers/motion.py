"""Trajectories: the motion of disks from any start, at given times.

The equations are those of :mod:`.dynamics`, with dashpots, under gravity and the loads, from t = 0 on. The integrator
takes whole steps of one length, whatever is asked for. A time between two of them is reached by one shorter step of a
motion of its own, so times that are looked at change nothing of what follows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

import numpy as np

from ..scene import Scene, SceneError
from ..scene.errors import show
from ..state import FloatArray, State
from .dynamics import Dynamics, DynamicsError, Ramp
from .problem import Problem
from .size import check_memory
from .timestep import resolve_time_step
from .work import stored

#: Part of a time step within which a time is that of a whole step.
SAME = 1e-9


@dataclass(frozen=True)
class Trajectory:
    """States of a motion at ``times`` (t,), and what is summed over their disks. Energies are in mg R."""

    problem: Problem
    times: FloatArray
    states: tuple[State, ...]
    time_step: float

    @property
    def gravity(self) -> float:
        """Part of g under which the disks move."""
        return _gravity(self.problem)

    @property
    def translation(self) -> FloatArray:
        """(t,) kinetic energy of the centres."""
        return np.array([0.5 * self.problem.packing.mass @ np.sum(s.velocity**2, axis=1) for s in self.states])

    @property
    def rotation(self) -> FloatArray:
        """(t,) kinetic energy of the spins."""
        return np.array([0.5 * self.problem.packing.inertia @ s.angular_velocity**2 for s in self.states])

    @property
    def height(self) -> FloatArray:
        """(t,) energy in gravity, above the floor."""
        return self.gravity * self._weights

    @property
    def elastic(self) -> FloatArray:
        """(t,) energy of all springs, normal, tangential and rolling."""
        return np.array([stored(self.problem, s) for s in self.states]) - self._weights

    @property
    def momentum(self) -> FloatArray:
        """(t, 2)."""
        return np.array([self.problem.packing.mass @ s.velocity for s in self.states])

    @property
    def angular_momentum(self) -> FloatArray:
        """(t,) about the lower left corner of the box, spins included, counter-clockwise."""
        mass, inertia = self.problem.packing.mass, self.problem.packing.inertia
        found = []
        for s in self.states:
            (x, z), (vx, vz) = s.position.T, s.velocity.T
            found.append(mass @ (x * vz - z * vx) + inertia @ s.angular_velocity)
        return np.array(found)

    @property
    def _weights(self) -> FloatArray:
        return np.array([self.problem.weight @ s.position[:, 1] for s in self.states])


def _gravity(problem: Problem) -> float:
    return 0.0 if problem.scene.motion.weightless else 1.0


def trajectory(
    scene: Scene,
    times: Sequence[float] | FloatArray,
    *,
    start: State | None = None,
    progress: Callable[[float, float, str], None] | None = None,
) -> Trajectory:
    """The motion of the disks of a scene at ``times``, in sqrt(R/g) since the start.

    ``start`` : a state to begin with, in place of the packing without springs. Its motion is that of the scene, if the
    scene has one. The loads grow to their values over ``protocol.ramp_time``.

    Raises
    ------
    SceneError
        For times that are not in order, or more steps than the protocol allows; a scene for another method; a motion or
        a start of another number of disks.
    DynamicsError
        When the motion blows up.
    """
    wanted, protocol = checked_times(times), scene.protocol
    if protocol.method not in ("auto", "dynamics"):
        raise SceneError(f"protocol.method = {protocol.method!r}: must be auto or dynamics, a motion has inertia")
    if protocol.load_factors != (1.0,):
        raise SceneError(f"protocol.load_factors = {show(list(protocol.load_factors))}: must be left out for a motion")
    check_memory(scene, scene.packing.disk_count)
    problem = Problem.from_scene(scene)
    given = scene.motion.of(problem.packing)
    state = problem.bare_state() if start is None else start
    if len(state.position) != problem.n or state.box != problem.packing.box:
        raise SceneError(f"start: a state of {len(state.position)} disks, must be one of this packing of {problem.n}")
    if start is None or given.any():
        state = replace(state, velocity=given[:, :2].copy(), angular_velocity=given[:, 2].copy())
    problem = problem.with_loads(state.position)
    load: Ramp = (0.0, 1.0, protocol.ramp_time) if scene.loads else (0.0, 0.0, 0.0)
    gravity: Ramp = (_gravity(problem), _gravity(problem), 0.0)
    step = resolve_time_step(problem)
    if wanted[-1] > step * protocol.maximum_steps:
        raise SceneError(
            f"times: {wanted[-1]:g} is {wanted[-1] / step:.3g} steps of {step:g}, must be at most "
            f"protocol.maximum_steps = {protocol.maximum_steps}"
        )
    dynamics = Dynamics(problem, state, protocol.integrator, step)
    dynamics.set_ramps(gravity, load)
    states = []
    for time in wanted:
        steps = math.floor(time / step + SAME) - dynamics.steps
        if steps:
            dynamics.advance(steps)
        rest = time - dynamics.steps * step
        states.append(_reached(dynamics, rest if rest > SAME * step else 0.0))
        if progress is not None:
            progress(float(time), float(wanted[-1]), "motion")
    return Trajectory(problem, wanted, tuple(states), step)


def _reached(dynamics: Dynamics, rest: float) -> State:
    """The state at the end of one more step of length ``rest``, which the motion itself does not take."""
    state = dynamics.state()
    if rest:
        one = Dynamics(dynamics.problem, state, dynamics.problem.scene.protocol.integrator, rest)
        start, end, duration = dynamics.load
        now, then = (
            start + (end - start) * (min(time / duration, 1.0) if duration else 1.0)
            for time in (dynamics.time, dynamics.time + rest)
        )
        one.set_ramps(dynamics.gravity, (now, then, rest))
        one.advance(1)
        state = replace(one.state(), load_factor=then)
    if not (np.isfinite(state.position).all() and np.isfinite(state.velocity).all()):
        raise DynamicsError(dynamics._blow_up())
    return state


def checked_times(times: Any) -> FloatArray:
    """(t,) times; SceneError unless they are finite numbers that grow, from 0 on."""
    given: list[Any] = list(times) if np.iterable(times) and not isinstance(times, (str, bytes)) else [None]
    numbers = all(isinstance(one, Real) and not isinstance(one, (bool, np.bool_)) for one in given)
    found = np.array([float(one) for one in given]) if numbers and given else np.array([np.nan])
    if not np.isfinite(found).all():
        raise SceneError(f"times = {' '.join(show(times).split())}: must be a list of one or more finite numbers")
    if found[0] < 0.0 or (np.diff(found) <= 0.0).any():
        bad = int(np.argmax(np.diff(found, prepend=-math.ulp(0.0)) <= 0.0)) if found[0] >= 0.0 else 0
        raise SceneError(f"times[{bad}] = {found[bad]:g}: must be 0 or more, and more than the one before")
    return found
