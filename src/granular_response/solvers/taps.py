"""Taps of a packing at rest: its box moves as :class:`..scene.Taps` says."""

from __future__ import annotations

from ..state import State
from .dynamics import Dynamics, Stop
from .problem import Problem
from .settle import PROTOCOL, settle
from .timestep import motion_step, resolve_time_step


def tapped(problem: Problem, rest: State, taps: int, amplitude: float, duration: float) -> State:
    """The equilibrium after a number of taps, each of which begins when the packing is at rest again.

    In the frame of the box gravity goes from 1 to 1 + ``amplitude``, to 1 - ``amplitude`` and back to 1, in a
    ``duration`` in sqrt(R/g) that is rounded to four times whole steps. Raises what :func:`.settle.settle` raises.
    """
    protocol = problem.scene.protocol
    stop = Stop.of(problem)
    most, least = 1.0 + amplitude, 1.0 - amplitude
    for _ in range(taps):
        thrown = 0.25 * amplitude * duration  # speed with which disks may leave each other beyond 1 g
        step = motion_step(problem, 0.5 * thrown**2) if amplitude > 1.0 else resolve_time_step(problem)
        dynamics = Dynamics(problem, rest, protocol.integrator, step)
        steps = round(0.25 * duration / dynamics.time_step)
        quarter = steps * dynamics.time_step
        dynamics.set_ramps(gravity=(1.0, most, quarter))
        dynamics.advance(steps)
        dynamics.set_ramps(gravity=(most, least, 2.0 * quarter))
        dynamics.advance(2 * steps)
        rest = settle(problem, dynamics.state(), PROTOCOL, stop, what="taps", gravity=(least, 1.0, quarter))
    return rest
