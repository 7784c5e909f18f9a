"""From motion to equilibrium: dynamics until a packing is nearly at rest, then statics.

The one hand-over there is. When it happens, how often it is tried and what lies between two tries depends on what
the dynamics is for; the two ways below are all that differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from ..errors import EquilibriumError, SolveError
from ..kernels.integrators import INTEGRATORS, lead
from ..state import FloatArray, Reached, State
from .dynamics import OPTIONS as MOTION
from .dynamics import Dynamics, Ramp, Stop, relax
from .energy import minimise
from .equilibrium import OPTIONS, finish
from .overlaps import overlap_at_start
from .problem import Problem
from .stability import Spectrum
from .system import StaticSystem
from .timestep import Pace, later_pace, resolve_time_step

#: Displacement along an unstable direction, of the disk that it moves most (mean radii).
NUDGE = 1e-6


class NotSettled(SolveError, RuntimeError):
    """A packing did not come to rest."""


@dataclass(frozen=True)
class HandOver:
    """How dynamics hands over to statics."""

    tries: int  #: how often statics is tried
    fallen: float = 1.0  #: part of its largest value since the last try to which the kinetic energy falls
    nudged: bool = False  #: from the third try on, dynamics starts from an unstable equilibrium, displaced a little
    wait: float = 20.0  #: time between two tries: some swings of the slowest modes of the paper's slabs, in sqrt(R/g)


#: Rest under gravity, and loads by dynamics: the fall is long, and a wait costs little of it.
PROTOCOL = HandOver(tries=8, nudged=True)
#: The end of a branch on a path. It begins at rest, so each try has a hundredth of the largest energy before it.
CROSSING = HandOver(tries=6, fallen=1e-2)
#: Largest kinetic energy per disk at a try of a crossing.
CROSSING_STOP = 1e-9


def settle(
    problem: Problem,
    start: State,
    how: HandOver,
    stop: Stop,
    *,
    what: str,
    gravity: Ramp = (1.0, 1.0, 0.0),
    load: Ramp = (0.0, 0.0, 0.0),
    fall: bool = False,
    accept: Callable[[State], bool | None] = lambda state: state.certificate.stable,
    progress: Callable[[Dynamics, float], None] | None = None,
) -> State:
    """The certified equilibrium in which the motion from ``start`` ends.

    Parameters
    ----------
    problem : with its loads chosen.
    start : where the motion begins.
    how, stop : the hand-over, and when it is first tried.
    what : that the packing comes to rest under, for messages.
    gravity, load : linear ramps ``(from, to, duration)``.
    fall : whether this is the fall under gravity, which in large packings goes on with larger steps.
    accept : whether an equilibrium will do; by default, when it is stable.
    progress : as of :func:`.dynamics.relax`; may end the motion by raising.

    Raises
    ------
    NotSettled
        When the steps run out, or no try leads to an equilibrium.
    DynamicsError
        When the motion blows up, or a load carries a disk off.
    """
    pace = Pace(problem.scene.protocol.integrator, resolve_time_step(problem), 0.0)
    dynamics = Dynamics(problem, start, *pace[:2])
    held = (load[1], load[1], 0.0)

    def left() -> Stop:
        """The stop with what is left of the steps."""
        return replace(stop, maximum_steps=max(stop.maximum_steps - spent - dynamics.steps, 0))

    spent, first = 0, Reached()  #: steps of motions that have been started again, and the record of their first pace
    stop = replace(stop, fallen=how.fallen)
    later = later_pace(problem) if fall else None
    if later is None:
        settled = relax(dynamics, stop, gravity=gravity, load=load, progress=progress)
    else:
        steps = min(math.ceil((gravity[2] + later.after) / pace.time_step), stop.maximum_steps)
        settled = relax(dynamics, replace(stop, maximum_steps=steps), gravity=gravity, progress=progress)
        if not settled.reached.settled and steps < stop.maximum_steps:
            first, spent = Reached(first_steps=steps, first_time_step=pace.time_step), steps
            settled, pace = in_step(settled, pace.integrator), later
            dynamics = Dynamics(problem, settled, *pace[:2])
            settled = relax(dynamics, left(), progress=progress)
    why = ""
    for attempt in range(1, how.tries + 1):
        kinetic = settled.reached.kinetic_energy or 0.0
        moving = kinetic > MOTION.nearly * stop.kinetic_energy
        nearly_still = math.sqrt(MOTION.nearly) * stop.acceleration  # that goes as the root of the energy
        moving = moving and not (settled.reached.mean_acceleration or math.inf) < nearly_still
        # steps that run out within a ramp leave another load than the one that is asked for
        if not settled.reached.settled and (moving or settled.load_factor != load[1]):
            break
        try:
            found = _statics(problem, settled, pace.integrator)
            if accept(found):
                steps = spent + dynamics.steps
                return replace(found, reached=replace(first.after(found.reached), steps=steps))
            why = ": the equilibrium found is unstable"
            if how.nudged and attempt > 2:
                system = StaticSystem(problem, found)
                displaced = nudged(problem, found, Spectrum(system, system.at(found)).direction)
                spent += dynamics.steps
                dynamics = Dynamics(problem, displaced, *pace[:2])
        except EquilibriumError as error:
            why = f": {error}"
        if not settled.reached.settled or attempt == how.tries or left().maximum_steps == 0:
            break
        settled = relax(dynamics, replace(left(), least_time=how.wait), load=held)
        settled = replace(settled, reached=replace(settled.reached, more_relaxations=attempt))
    if settled.reached.settled and why and left().maximum_steps > 0:
        raise NotSettled(f"the packing is nearly at rest under {what}, but finds no stable equilibrium{why}")
    raise NotSettled(not_settled(problem, settled, what) + why)


def not_settled(problem: Problem, state: State, what: str) -> str:
    """The message for a packing that is still moving under ``what``."""
    why = [problem.too_soft, "" if what == "load" else overlap_at_start(problem)]
    return "; ".join(
        [
            f"the packing did not come to rest under {what} within protocol.maximum_steps = "
            f"{problem.scene.protocol.maximum_steps} (kinetic energy {state.reached.kinetic_energy:.1e} per disk)",
            *filter(None, why),
        ]
    )


def in_step(settled: State, integrator: str) -> State:
    """A state in motion with its disks where its springs, which are ahead of them, are already."""
    time = lead(INTEGRATORS[integrator]) * (settled.reached.time_step or 0.0)
    position, angle = settled.position + time * settled.velocity, settled.angle + time * settled.angular_velocity
    return replace(settled, position=position, angle=angle)


def _statics(problem: Problem, settled: State, integrator: str) -> State:
    """The equilibrium beside a nearly settled state: without friction the minimum of the energy."""
    if problem.rotations:
        start = problem.with_static_forces(in_step(settled, integrator))
        return finish(problem, start, maximum_iterations=OPTIONS.tries)
    found = minimise(problem, problem.relisted(settled), load_factor=settled.load_factor)
    return replace(found, reached=found.reached.after(settled.reached))


def nudged(problem: Problem, state: State, direction: FloatArray) -> State:
    """An equilibrium displaced a little along ``direction`` (dof,), with or against the most unstable one."""
    n = problem.n
    shift = NUDGE * direction[: 2 * n].reshape(2, n).T
    return problem.with_static_forces(replace(state, position=state.position + shift))
