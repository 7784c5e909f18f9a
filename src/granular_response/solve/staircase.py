"""Loading in stages: statics where it goes easily, dynamics for the rest of a stage.

A quasi-static path through a disordered packing with friction meets many small events, and locating each of them
by statics costs far more than it is worth when responses are averaged over an ensemble. Here each stage, from
one load to the next, begins with static increments by plain Newton iterations. When these fail, or end in an
unstable state, the paper's protocol (Sec. III.C) carries the packing over what is left of the stage: a linear ramp,
relaxation, and the static finish. The dynamic part tends to the quasi-static path like the inverse of the ramp's
duration.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .equilibrium import certify, external_force, newton
from .problem import Problem
from .solution import loaded_states
from .state import FloatArray, State
from .system import StaticSystem

#: First and shortest static increment, in mean disk weights.
FIRST_STEP, SHORTEST_STEP = 2.0, 0.5
#: Newton iterations after which a static increment counts as failed.
ITERATIONS = 8
#: Displacement after which contacts are listed again (mean radii); far below the skin of the list.
LISTED_AGAIN = 0.1


@dataclass(frozen=True)
class Stage:
    """How a stage went: load factors at its start, at the last static equilibrium, and at its end."""

    start: float
    static_until: float
    end: float

    @property
    def static(self) -> bool:
        return self.static_until >= self.end


def climb(problem: Problem, state: State, factor: float) -> tuple[State, Stage]:
    """The certified state at load ``factor``, reached from ``state`` through the loads between.

    Parameters
    ----------
    problem : with its loads chosen; its protocol's ``ramp_time`` is the time in which dynamics crosses a stage, or
        the same part of it as of the stage that is left.
    state : certified, at a load factor below ``factor``.

    Raises
    ------
    NotSettled, DynamicsError
        When the packing collapses on the way, or does not come to rest in the protocol's ``maximum_steps``.
    """
    start = state.load_factor
    if not factor > start:
        raise ValueError(f"load factors must increase, got {factor:g} after {start:g}")
    reached, done = _static(problem, state, factor)
    stage = Stage(start, reached.load_factor, factor)
    if done:
        return reached, stage
    part = (factor - reached.load_factor) / (factor - start)
    protocol = problem.scene.protocol
    scene = problem.scene.updated(
        {"protocol.method": "dynamics", "protocol.ramp_time": max(part * protocol.ramp_time, 1.0)}
    )
    _, [settled] = loaded_states(replace(problem, scene=scene), reached, [factor])
    return settled, stage


def _static(problem: Problem, state: State, target: float) -> tuple[State, bool]:
    """As far towards ``target`` as plain Newton iterations go, and whether that is all the way."""
    unit = max(float(np.hypot(problem.load[:, 0], problem.load[:, 1]).sum()), 1e-300)
    step = FIRST_STEP / unit
    factor = state.load_factor
    system = StaticSystem(problem, state)
    known = system.start(state)
    trial = None
    rate: FloatArray | None = None
    while factor < target:
        new = target if target - factor < 1.5 * step else factor + step
        guess = known.q if rate is None else known.q + (new - factor) * rate
        found, report = newton(system, known, external_force(problem, new), guess, maximum_iterations=ITERATIONS)
        moved = float(np.abs(found.configuration.q[: 2 * problem.n] - known.q[: 2 * problem.n]).max())
        if not report.converged or moved > LISTED_AGAIN:
            step = 0.5 * (new - factor)
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
    if trial is None:
        return state, False
    modes = system.negative_modes(trial)
    if modes:
        return state, False
    reached = system.state(trial, factor, method="statics")
    reached.information["certificate"] = certify(problem, reached, modes=modes)
    return reached, factor >= target
