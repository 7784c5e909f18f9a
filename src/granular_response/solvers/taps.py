"""Taps of a packing at rest: its box moves as :class:`..scene.Taps` says.

Disks that are thrown off land with the time step of a motion, which resolves their collisions. What is left of a tap
once they have landed is the end of a fall, and goes on with the time step of one.
"""

from __future__ import annotations

from dataclasses import replace

from ..state import State
from .dynamics import Dynamics, Stop, relax
from .problem import Problem
from .settle import PROTOCOL, NotSettled, in_step, not_settled, settle
from .timestep import motion_step, resolve_time_step

#: Mean acceleration of disks below which, for half a swing and while none falls, the disks of a tap have landed (g).
#: From 1 g on contacts that only weights close open, and collide again. Floor forces of the paper's slab after a tap of
#: 2 g are within 2e-3 mg of those by a quarter of the step with 0.1, 0.03 and 0.001 g alike, in 3.9, 4.8 and 6.2 s.
LANDED = 0.1


def tapped(problem: Problem, rest: State, taps: int, amplitude: float, duration: float) -> State:
    """The equilibrium after a number of taps, each of which begins when the packing is at rest again.

    In the frame of the box gravity goes from 1 to 1 + ``amplitude``, to 1 - ``amplitude`` and back to 1, in a
    ``duration`` in sqrt(R/g) that is rounded to four times whole steps. Raises what :func:`.settle.settle` raises.
    """
    integrator, stop = problem.scene.protocol.integrator, Stop.of(problem)
    most, least = 1.0 + amplitude, 1.0 - amplitude
    for _ in range(taps):
        thrown = 0.25 * amplitude * duration  # speed with which disks may leave each other
        dynamics = Dynamics(problem, rest, integrator, motion_step(problem, 0.5 * thrown**2))
        steps = round(0.25 * duration / dynamics.time_step)
        quarter = steps * dynamics.time_step
        dynamics.set_ramps(gravity=(1.0, most, quarter))
        dynamics.advance(steps)
        dynamics.set_ramps(gravity=(most, least, 2.0 * quarter))
        dynamics.advance(2 * steps)
        moving, gravity = dynamics.state(), (least, 1.0, quarter)
        if dynamics.time_step < resolve_time_step(problem):
            landed = relax(dynamics, replace(stop, kinetic_energy=0.0, acceleration=LANDED), gravity=gravity)
            if not landed.reached.settled:
                raise NotSettled(not_settled(problem, landed, "taps"))
            moving, gravity = in_step(landed, integrator), (1.0, 1.0, 0.0)
        rest = settle(problem, moving, PROTOCOL, stop, what="taps", gravity=gravity)
    return rest
