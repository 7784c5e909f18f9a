"""Quasi-static loading: a sequence of equilibria under a growing load (the limit of an infinitely slow ramp).

Each increment is solved with the return map of ``core.statics``. Where a contact goes on opening, sliding or
sticking throughout an increment the return map is exact for any length of the increment, so steps are chosen by
what Newton's method converges on. Where it does not converge even on the shortest step, explicit dynamics
carries the packing over the next bit of load and statics takes over again; both are recorded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from .dynamics import Dynamics, Stop, relax
from .equilibrium import EquilibriumError, certify, external_force, finish, newton
from .problem import Problem
from .state import State
from .system import StaticSystem

#: First and shortest load increments, in mean disk weights.
FIRST_STEP = 0.5
SHORTEST_STEP = 0.05
#: Load that dynamics crosses at once, in mean disk weights.
CROSSING = 2.0
#: Newton iterations after which the increment is halved instead.
ITERATIONS = 12


class PathError(RuntimeError):
    """The load path could not be continued."""


@dataclass
class PathRecord:
    """What happened on a load path: one entry per crossing by dynamics, ``(from, to)`` load factors."""

    increments: int = 0
    iterations: int = 0
    factorisations: int = 0
    crossings: list[tuple[float, float]] = field(default_factory=list)


def follow(
    problem: Problem,
    rest: State,
    factors: Sequence[float],
    *,
    integrator: str = "beeman",
    time_step: float = 5e-4,
    longest_step: float = np.inf,
    crossing_ramp: float = 20.0,
    progress: Callable[[float], None] | None = None,
    record: PathRecord | None = None,
) -> list[State]:
    """States at increasing load ``factors``, reached from ``rest`` through every smaller load.

    Parameters
    ----------
    problem : with its loads chosen.
    rest : certified state at load factor ``rest.load_factor``.
    factors : increasing multipliers of the loads.
    longest_step : bound on an increment, in mean disk weights.
    crossing_ramp : duration of the load ramp where dynamics takes over, in sqrt(R/g).

    Raises
    ------
    PathError
        When dynamics does not settle either: the packing collapses or cycles under this load.
    """
    record = PathRecord() if record is None else record
    unit = max(float(np.abs(problem.load[:, :2]).sum()), float(np.abs(problem.load).sum()), 1e-300)
    system = StaticSystem(problem, rest)
    known = system.start(rest)
    factor = rest.load_factor
    step = FIRST_STEP / unit
    shortest = SHORTEST_STEP / unit
    before: tuple[float, np.ndarray] | None = None
    results: list[State] = []
    trial = None
    for target in factors:
        if target < factor - 1e-12 * max(1.0, abs(factor)):
            raise PathError(f"load factors must increase, got {target:g} after {factor:g}")
        while trial is None or factor < target:
            new = min(factor + min(step, longest_step / unit), target)
            if target - new < 1e-3 * step:
                new = target
            start = known.q
            if before is not None and factor > before[0]:
                start = known.q + (known.q - before[1]) * ((new - factor) / (factor - before[0]))
            found, report = newton(
                system, known, external_force(problem, new), start, maximum_iterations=ITERATIONS
            )
            record.iterations += report.iterations
            if not report.converged and start is not known.q:
                found, report = newton(system, known, external_force(problem, new), maximum_iterations=ITERATIONS)
                record.iterations += report.iterations
            if report.converged:
                record.increments += 1
                before = (factor, known.q)
                factor, trial, known = new, found, found.configuration
                if report.iterations <= 5:
                    step *= 1.6
                elif report.iterations > 8:
                    step *= 0.7
                if progress is not None:
                    progress(factor)
                continue
            step = 0.5 * (new - factor)
            if step >= shortest:
                continue
            # dynamics over a stretch of load
            step = FIRST_STEP / unit
            new = min(factor + CROSSING / unit, target)
            here = system.state(trial, factor) if trial is not None else rest
            settled = _cross(problem, here, factor, new, integrator, time_step, crossing_ramp)
            record.crossings.append((factor, new))
            system = StaticSystem(problem, settled)
            known = system.start(settled)
            trial = system.trial(known, known.q)
            factor, before = new, None
        state = system.state(trial, target)
        certificate = certify(problem, state, modes=system.negative_modes(trial))
        results.append(
            replace(
                state,
                information={
                    "method": "path",
                    "certificate": certificate,
                    "increments": record.increments,
                    "newton_iterations": record.iterations,
                    "crossings": list(record.crossings),
                },
            )
        )
    return results


def _cross(problem, state, factor, new, integrator, time_step, ramp_time) -> State:
    dynamics = Dynamics(problem, state, integrator, time_step)
    load = (factor, new, ramp_time)
    energy = 1e-10
    for _ in range(4):
        settled = relax(dynamics, Stop(energy, maximum_steps=2_000_000), load=load)
        load = (new, new, 0.0)
        energy *= 1e-2
        try:
            return finish(problem, settled, load_factor=new)
        except EquilibriumError as error:
            last = error
    raise PathError(f"no equilibrium beyond load factor {factor:g}: {last}")
