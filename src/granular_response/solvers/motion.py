"""Trajectories: the motion of disks from any start, at given times.

The equations are those of :mod:`.dynamics`, with dashpots, under gravity and the loads, from t = 0 on. The integrator
takes whole steps of one length, whatever is asked for, which by default resolve a collision. A time between two of them
is reached by one shorter step of a motion of its own, so times that are looked at change no bit of what follows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..scene import Scene, SceneError
from ..scene.errors import show
from ..scene.given import finite_numbers
from ..state import FloatArray, State
from .dynamics import Dynamics, DynamicsError, Ramp, ramped
from .overlaps import too_deep
from .problem import Problem
from .size import check_memory
from .timestep import motion_step
from .work import stored

#: Part of a time step within which a time is that of a whole step.
SAME = 1e-9
#: Overlap (mean radii) by which a start may differ from that of the radii of the packing.
SAME_RADII = 1e-6
#: Most time steps between two looks at whether bodies pass through each other.
MOST_UNSEEN = 1000
_MOTION = ("position", "velocity", "angular_velocity")


@dataclass(frozen=True)
class Trajectory:
    """States of a motion at ``times`` (t,)."""

    problem: Problem
    times: FloatArray
    states: tuple[State, ...]
    stored: FloatArray  #: (t,) energy of springs and weights in mg R
    time_step: float

    def sums(self) -> dict[str, FloatArray]:
        """(t,) energies of all disks in mg R, and their sum; (t, 2) momentum; (t,) angular momentum, counter-clockwise.

        The energy in gravity is counted from the floor; the angular momentum about the lower left corner of the box,
        spins included.
        """
        packing, weight = self.problem.packing, self.problem.weight
        x, v, spin = (np.stack([getattr(s, name) for s in self.states]) for name in _MOTION)
        height = x[..., 1] @ weight
        parts = {
            "kinetic_energy": 0.5 * np.sum(v**2, axis=2) @ packing.mass,
            "rotational_energy": 0.5 * spin**2 @ packing.inertia,
            "potential_energy": 0.0 * height if self.problem.scene.motion.weightless else height,
            "elastic_energy": self.stored - height,
        }
        turning = (x[..., 0] * v[..., 1] - x[..., 1] * v[..., 0]) @ packing.mass + spin @ packing.inertia
        momentum = np.einsum("tna,n->ta", v, packing.mass)
        return {**parts, "energy": sum(parts.values()), "momentum": momentum, "angular_momentum": turning}


def trajectory(
    scene: Scene,
    times: Sequence[float] | FloatArray,
    *,
    start: State | None = None,
    progress: Callable[[float, float, str], None] | None = None,
) -> Trajectory:
    """The motion of the disks of a scene at ``times``, in sqrt(R/g) since the start.

    ``start`` : a state to begin with, in place of the packing without springs. Its motion is that of the scene, if the
    scene has one. The loads grow from those of the start to their values over ``protocol.ramp_time``.

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
    if scene.loads and protocol.load_factors != (1.0,):
        raise SceneError(f"protocol.load_factors = {show(list(protocol.load_factors))}: must be left out for a motion")
    check_memory(scene, scene.packing.disk_count)
    problem = Problem.from_scene(scene)
    given = scene.motion.of(problem.packing)
    state = problem.bare_state() if start is None else start
    if len(state.position) != problem.n:
        raise SceneError(f"start: a state of {len(state.position)} disks, must be one of this packing of {problem.n}")
    pairs, reach = state.pairs, problem.packing.radius
    overlap = reach[pairs.first] + reach[pairs.second] - np.linalg.norm(state.pair_separation(), axis=1)
    other = np.abs(overlap - pairs.overlap)[pairs.touching].max(initial=0.0) > SAME_RADII
    if other or state.box != problem.packing.box:
        raise SceneError("start: a state of other radii or in another box, must be one of this packing")
    if start is None or given.any():
        state = replace(state, velocity=given[:, :2].copy(), angular_velocity=given[:, 2].copy())
    problem = problem.with_loads(state.position)
    if state.load_factor and len(problem.held):
        raise SceneError("start: a state under load, must be one without where a load displaces a disk, from there")
    load: Ramp = (state.load_factor, 1.0, protocol.ramp_time) if scene.loads else (0.0, 0.0, 0.0)
    g = 0.0 if scene.motion.weightless else 1.0
    step = motion_step(problem, _largest_energy(problem, state), float(state.largest_normal_force().max()))
    if wanted[-1] > step * protocol.maximum_steps:
        raise SceneError(
            f"times: {wanted[-1]:g} is {wanted[-1] / step:.3g} steps of {step:g}, must be at most "
            f"protocol.maximum_steps = {protocol.maximum_steps}"
        )
    dynamics = Dynamics(problem, state, protocol.integrator, step, uncut=True)
    dynamics.set_ramps((g, g, 0.0), load)
    states = []
    for time in wanted:
        _advance(dynamics, math.floor(time / step + SAME))
        rest = time - dynamics.steps * step
        states.append(_reached(dynamics, rest if rest > SAME * step else 0.0))
        if progress is not None:
            progress(float(time), float(wanted[-1]), "motion")
    energy = np.array([energy for _, energy in states])
    return Trajectory(problem, wanted, tuple(one for one, _ in states), energy, step)


def _largest_energy(problem: Problem, state: State) -> float:
    """Estimate of the largest energy with which a disk hits another one or a wall, in mg R: from start and fall."""
    energy = 0.5 * np.sum(state.velocity**2, axis=1)
    if not problem.scene.motion.weightless:
        energy = energy + state.position[:, 1]
    return float((problem.packing.mass * energy).max())


def _advance(dynamics: Dynamics, until: int) -> None:
    """Advance to a number of steps; raises DynamicsError where bodies pass through each other."""
    n, radius = dynamics.problem.n, float(dynamics.problem.packing.radius.min())
    while dynamics.steps < until:
        speed = float(np.hypot(dynamics.v[:n], dynamics.v[n : 2 * n]).max())
        steps = min(MOST_UNSEEN, max(1, int(0.5 * radius / max(speed * dynamics.time_step, 1e-300))))
        dynamics.advance(min(steps, until - dynamics.steps))
        if deep := too_deep(dynamics.problem, dynamics.state()):
            raise DynamicsError(
                f"{deep} at time {dynamics.time:.4g}, as much as a radius, and may pass through each other: take "
                "smaller velocities or a larger contact.normal_stiffness"
            )


def _reached(dynamics: Dynamics, rest: float) -> tuple[State, float]:
    """The state at the end of one more step of length ``rest``, which the motion itself does not take, and the energy
    that is stored there."""
    state, at = dynamics.state(), dynamics
    if rest:
        one = Dynamics(dynamics.problem, state, dynamics.problem.scene.protocol.integrator, rest)
        now, then = (ramped(dynamics.load, time) for time in (dynamics.time, dynamics.time + rest))
        one.set_ramps(dynamics.gravity, (now, then, rest))
        one.advance(1)
        state, at = replace(one.state(), load_factor=then), one
    if not (np.isfinite(state.position).all() and np.isfinite(state.velocity).all()):
        raise DynamicsError(dynamics._blow_up())
    return state, stored(at.problem, state, at.rows.seen)


def checked_times(times: Any) -> FloatArray:
    """(t,) times; SceneError unless they are finite numbers that grow, from 0 on."""
    found = np.array(finite_numbers(times) or [])
    if not found.size:
        raise SceneError(f"times = {' '.join(show(times).split())}: must be a list of one or more finite numbers")
    if found[0] < 0.0 or (np.diff(found) <= 0.0).any():
        bad = int(np.argmax(np.diff(found, prepend=-math.ulp(0.0)) <= 0.0)) if found[0] >= 0.0 else 0
        raise SceneError(f"times[{bad}] = {found[bad]:g}: must be 0 or more, and more than the one before")
    return found
