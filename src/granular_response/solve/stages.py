"""Loading in stages (``protocol.method: stages``): statics where it goes easily, dynamics for the rest of a stage.

A quasi-static path through a disordered packing with friction meets many small events, and locating each of them
by statics costs far more than it is worth when responses are averaged over an ensemble. Here each stage, from
one load to the next, begins with static increments by plain Newton iterations. When these fail, or end in an
unstable state, the paper's protocol (Sec. III.C) carries the packing over what is left of the stage: a linear ramp,
relaxation, and the static finish. The dynamic part tends to the quasi-static path like the inverse of the ramp's
duration. In that limit neither inertia nor dashpots matter, so they may be chosen for the longest stable step
(``protocol.inertia``, ``protocol.stage_damping``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import GranularError
from ..state import FloatArray, Reached, State
from .choice import stop_energy
from .dynamics import Dynamics, Stop
from .equilibrium import certify, external_force, newton
from .problem import Problem
from .settle import STAGE, settle
from .system import StaticSystem
from .timestep import stage_time_step

#: First and shortest static increment, in mean disk weights.
FIRST_STEP, SHORTEST_STEP = 2.0, 1.0
#: Newton iterations after which a static increment counts as failed.
ITERATIONS = 8
#: Displacement after which contacts are listed again (mean radii); far below the skin of the list.
LISTED_AGAIN = 0.1
#: Shortest ramp, in sqrt(R/g).
SHORTEST_RAMP = 1.0


class Collapsed(GranularError, RuntimeError):
    """The load has pushed its disk down farther than allowed, to ``height``."""

    def __init__(self, load: float, height: float) -> None:
        super().__init__(f"the loaded disk sinks to height {height:.3g} on the way to load {load:g}")
        self.height = height


@dataclass(frozen=True)
class Stage:
    """How a stage went: load factors at its start, at the last static equilibrium, and at its end."""

    start: float
    static_until: float
    end: float

    @property
    def static(self) -> bool:
        return self.static_until == self.end


def climb(
    problem: Problem,
    state: State,
    factor: float,
    *,
    ramp_time: float | None = None,
    statics: bool = True,
    lowest: float = -np.inf,
) -> tuple[State, Stage]:
    """The certified state at load ``factor``, reached from ``state`` through the loads between.

    Parameters
    ----------
    problem : with its loads chosen.
    state : certified, at another load factor.
    ramp_time : time in which dynamics crosses the stage, or the same part of it as of the stage that is left; that of
        the protocol if None.
    statics : False leaves all to dynamics, which saves time where statics is known to fail.
    lowest : height below which the first loaded disk must not sink.

    Raises
    ------
    Collapsed
        When the loaded disk sinks below ``lowest``.
    NotSettled, DynamicsError
        When the packing does not come to rest in the protocol's ``maximum_steps``, or falls for ever.
    """
    start = state.load_factor
    if factor == start:
        return state, Stage(start, start, factor)
    reached, done = _static(problem, state, factor) if statics else (state, False)
    stage = Stage(start, reached.load_factor, factor)
    disk = int(problem.load_disk[0])
    if done:
        if reached.position[disk, 1] < lowest:
            raise Collapsed(factor, float(reached.position[disk, 1]))
        return reached, stage
    part = (factor - reached.load_factor) / (factor - start)
    whole = problem.scene.protocol.ramp_time if ramp_time is None else ramp_time
    return _dynamic(problem, reached, factor, max(part * whole, SHORTEST_RAMP), lowest), stage


def _dynamic(problem: Problem, start: State, factor: float, ramp_time: float, lowest: float) -> State:
    """Ramp, hold, relax to the protocol's stop energy, and finish by Newton iterations."""
    protocol = problem.scene.protocol
    stop = Stop(stop_energy(problem), protocol.stop_rule, protocol.maximum_steps)
    disk = int(problem.load_disk[0])

    def watch(dynamics: Dynamics) -> None:
        height = dynamics.height(disk)
        if height < lowest:
            raise Collapsed(factor, height)

    ramp = (start.load_factor, factor, ramp_time)
    return settle(
        problem.in_stages(), start, STAGE, stop,
        what=f"load {factor:g}", load=ramp, watch=watch, time_step=stage_time_step(problem),
    )  # fmt: skip


def _static(problem: Problem, state: State, target: float) -> tuple[State, bool]:
    """As far towards ``target`` as plain Newton iterations go, and whether that is all the way."""
    unit = problem.load_size
    factor = state.load_factor
    sense = 1.0 if target > factor else -1.0
    step = FIRST_STEP / unit
    system = StaticSystem(problem, state)
    known = system.start(state)
    trial = None
    rate: FloatArray | None = None
    while factor != target:
        new = target if abs(target - factor) < 1.5 * step else factor + sense * step
        guess = system.displaced(known.q if rate is None else known.q + (new - factor) * rate, new)
        found, report = newton(system, known, external_force(problem, new), guess, maximum_iterations=ITERATIONS)
        moved = float(np.abs(found.configuration.q[: 2 * problem.n] - known.q[: 2 * problem.n]).max())
        if not report.converged or moved > LISTED_AGAIN:
            step = 0.5 * abs(new - factor)
            rate = None
            if step * unit < SHORTEST_STEP:
                break
            continue
        rate = (found.configuration.q - known.q) / (new - factor)
        step *= 1.5
        factor, known, trial = new, found.configuration, found
        if np.abs(known.q[: 2 * problem.n]).max() > LISTED_AGAIN:
            state = problem.relisted(system.state(trial, factor))
            system = StaticSystem(problem, state)
            known, rate = system.start(state), None
            trial = system.trial(known, known.q)
    if trial is None or system.meets_unlisted(trial.configuration.q):
        return state, False
    modes = system.negative_modes(trial)
    if modes:
        return state, False
    there = system.state(trial, factor)
    reached = Reached(method="statics", certificate=certify(problem, there, modes=modes))
    return replace(there, reached=reached), factor == target
