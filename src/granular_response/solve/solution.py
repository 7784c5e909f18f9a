"""A solved scene: its state at rest and under load."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..scene import Scene, SceneError
from ..state import Crossing, State
from .choice import Choice, finishes_statically, load_method, rest_method, stop_energy
from .dynamics import Dynamics, DynamicsError, Stop, relax
from .energy import minimise
from .equilibrium import EquilibriumError, certify, check_overlaps, finish
from .nested import rest_start
from .path import follow
from .problem import Problem
from .system import StaticSystem
from .timestep import resolve_time_step

#: How often the static finish is tried, and the time of dynamics between two tries.
ATTEMPTS, MORE_TIME = 8, 20.0

#: Kinetic energy over the stop energy up to which a state that has not settled is tried all the same.
NEARLY = 1e3

#: Called as ``progress(done, total, what)``.
Progress = Callable[[float, float, str], None]


class NotSettled(RuntimeError):
    """A packing did not come to rest."""


@dataclass(frozen=True)
class Solution:
    """Rest state and loaded states of a scene.

    ``problem`` has its loads on disks; ``loaded`` holds one state for each of ``load_factors``, in order
    (empty for a scene without loads).
    """

    scene: Scene
    problem: Problem
    rest: State
    loaded: tuple[State, ...]
    load_factors: tuple[float, ...]
    rest_choice: Choice
    load_choice: Choice | None

    @property
    def total_force(self) -> float:
        """Sum of the magnitudes of the applied forces at load factor 1."""
        return float(np.hypot(self.problem.load[:, 0], self.problem.load[:, 1]).sum())


def solve_scene(scene: Scene, *, load_factors: Sequence[float] = (1.0,), progress: Progress | None = None) -> Solution:
    """Settle a scene under gravity, then load it.

    Parameters
    ----------
    scene : what to solve.
    load_factors : increasing multipliers of the scene's loads at which states are kept; on a path every state
        has passed through the smaller loads before it.
    progress : called with the part done of a stage, 1 and the stage's name.

    Raises
    ------
    SceneError, NotSettled, DynamicsError, EquilibriumError, PathError
        Each with one line that says what to change.
    """
    _check_growing([0.0, *load_factors])
    problem = Problem.from_scene(scene)
    rest = rest_state(problem, progress=progress)
    problem = problem.with_loads(rest.position)
    rest_choice = rest_method(problem)
    if not scene.loads:
        check_overlaps(problem, rest)
        return Solution(scene, problem, rest, (), (), rest_choice, None)
    choice, states = loaded_states(problem, rest, load_factors, progress=progress)
    for state in (rest, *states):
        check_overlaps(problem, state)
    return Solution(scene, problem, rest, tuple(states), tuple(map(float, load_factors)), rest_choice, choice)


def continue_solution(
    solution: Solution, load_factors: Sequence[float], *, progress: Progress | None = None
) -> Solution:
    """The solution with states at further ``load_factors``, as if they had been asked for from the beginning.

    A path goes on from its last state, dynamics from rest, and both give the bits of a run that was never cut.

    Raises
    ------
    SceneError
        When the scene has no loads, or the factors do not grow from the largest one so far.
    NotSettled, DynamicsError, EquilibriumError, PathError
        As of ``solve_scene``.
    """
    if not solution.loaded:
        raise SceneError("loads: none in this scene, so there is nothing to raise")
    factors = [float(factor) for factor in load_factors]
    _check_growing([solution.load_factors[-1], *factors])
    again = solution.load_choice is not None and solution.load_choice.method == "dynamics"
    start = solution.rest if again else solution.loaded[-1]
    _, states = loaded_states(solution.problem, start, factors, progress=progress)
    for state in states:
        check_overlaps(solution.problem, state)
    return replace(
        solution,
        loaded=(*solution.loaded, *states),
        load_factors=(*solution.load_factors, *factors),
    )


def _check_growing(factors: Sequence[float]) -> None:
    """The first one stands for what is there already."""
    if not all(np.isfinite(factors)) or any(after <= before for before, after in pairwise(factors)):
        listed = ", ".join(f"{factor:g}" for factor in factors[1:])
        raise SceneError(f"load factors {listed}: must be finite and grow, from above {factors[0]:g}")


def rest_state(problem: Problem, *, progress: Progress | None = None) -> State:
    """The certified state at rest under gravity, prepared as the scene says."""
    if problem.rotations and problem.scene.preparation.gravity == "frictionless":
        smooth = rest_state(problem.without_friction(), progress=progress)
        # no tangential spring is stretched: an equilibrium with friction too
        return finish(problem, problem.with_static_forces(smooth))
    choice = rest_method(problem)
    if choice.method == "minimise":
        return minimise(problem, rest_start(problem))
    preparation = problem.scene.preparation
    slow = preparation.gravity == "slow"
    gravity = (0.0, 1.0, preparation.ramp_time) if slow else (1.0, 1.0, 0.0)
    return _relaxed(problem, problem.bare_state(), "gravity", progress, gravity=gravity, load=(0.0, 0.0, 0.0))


def loaded_states(
    problem: Problem, rest: State, load_factors: Sequence[float], *, progress: Progress | None = None
) -> tuple[Choice, list[State]]:
    """States at increasing ``load_factors`` from the same rest state, and the method that found them.

    Dynamics ramps the load from rest to each factor anew, as the paper does; the other methods pass every
    smaller load on the way.
    """
    choice = load_method(problem)
    protocol = problem.scene.protocol
    factors = [float(f) for f in load_factors]
    if choice.method == "dynamics":
        states = []
        for factor in factors:
            ramp = (rest.load_factor, factor, protocol.ramp_time)
            states.append(_relaxed(problem, rest, "load", progress, gravity=(1.0, 1.0, 0.0), load=ramp))
        return choice, states
    if choice.method == "minimise":
        states = []
        state = rest
        for done, factor in enumerate(factors, 1):
            try:
                state = minimise(problem, state, load_factor=factor)
            except EquilibriumError:
                # the packing collapses or rearranges here: its motion decides where it comes to rest
                before = state
                ramp = (before.load_factor, factor, protocol.ramp_time)
                state = _relaxed(problem, before, "load", progress, gravity=(1.0, 1.0, 0.0), load=ramp)
                moved = float(np.hypot(*(state.position - before.position).T).max())
                crossing = Crossing(before.load_factor, factor, "no equilibrium nearby", moved)
                state = replace(state, reached=replace(state.reached, crossings=(crossing,)))
            states.append(state)
            if progress is not None:
                progress(done, len(factors), "load")
        return choice, states
    largest = max(abs(f) for f in factors)

    def report(factor: float) -> None:
        if progress is not None:
            progress(abs(factor), largest, "load")

    states = follow(
        problem, rest, factors, integrator=protocol.integrator, crossing_ramp=protocol.ramp_time,
        maximum_steps=protocol.maximum_steps, progress=report,
    )  # fmt: skip
    return choice, states


def _relaxed(problem: Problem, start: State, stage: str, progress: Progress | None, *, gravity, load) -> State:
    """Dynamics to rest as the protocol says, and the static finish."""
    protocol = problem.scene.protocol
    dynamics = Dynamics(problem, start, protocol.integrator, resolve_time_step(problem))
    stop = Stop(stop_energy(problem), protocol.stop_rule, protocol.maximum_steps, _crossing_time(problem))
    report = None
    if progress is not None:
        highest = [stop.kinetic_energy * 10.0, 0.0]

        def report(_: int, energy: float) -> None:
            highest[0] = max(highest[0], energy)
            span = np.log(highest[0] / stop.kinetic_energy)
            done = np.log(highest[0] / max(energy, stop.kinetic_energy)) / span
            highest[1] = max(highest[1], float(done)) if highest[0] > energy else highest[1]
            progress(highest[1], 1.0, stage)

    settled = relax(dynamics, stop, gravity=gravity, load=load, progress=report)
    if not finishes_statically(problem):
        if protocol.static_finish and not settled.reached.settled:
            raise NotSettled(_not_settled(problem, settled, stage))
        certificate = certify(problem, settled)
        return replace(settled, reached=replace(settled.reached, certificate=certificate))
    energy_left = settled.reached.kinetic_energy or 0.0
    if not settled.reached.settled and energy_left > NEARLY * stop.kinetic_energy:
        raise NotSettled(_not_settled(problem, settled, stage))
    failure: Exception | None = None
    for attempt in range(ATTEMPTS):
        try:
            if not problem.rotations:
                finished = minimise(problem, problem.relisted(settled), load_factor=load[1])
                return replace(finished, reached=finished.reached.after(settled.reached))
            finished = finish(problem, settled)
            if finished.certificate.stable:
                return finished
            failure = EquilibriumError("the equilibrium found is unstable")
            if attempt > 1:
                dynamics = Dynamics(problem, _nudged(problem, finished), protocol.integrator, dynamics.time_step)
        except EquilibriumError as error:
            failure = error
        if not settled.reached.settled:
            break
        dynamics.set_ramps(load=(load[1], load[1], 0.0))
        dynamics.advance(round(MORE_TIME / dynamics.time_step))
        settled = replace(dynamics.state(), reached=replace(settled.reached, more_relaxations=attempt + 1))
    raise NotSettled(f"{_not_settled(problem, settled, stage)}: {failure}")


def _crossing_time(problem: Problem) -> float:
    """In which a compression wave runs through the packing; before, parts of it do not know of each other."""
    return float(problem.packing.position[:, 1].max()) / (2.0 * problem.scene.contact.normal_stiffness**0.5)


def _not_settled(problem: Problem, settled: State, stage: str) -> str:
    return (
        f"the packing did not come to rest under {stage} within protocol.maximum_steps = "
        f"{problem.scene.protocol.maximum_steps} (kinetic energy {settled.reached.kinetic_energy:.1e} per disk)"
    )


def _nudged(problem: Problem, state: State) -> State:
    """An unstable equilibrium displaced a little along its unstable direction."""
    system = StaticSystem(problem, state)
    known = system.start(state)
    direction = system.unstable_direction(system.trial(known, known.q))[: 2 * problem.n]
    moved = state.position + 1e-6 * direction.reshape(2, problem.n).T
    return problem.with_static_forces(replace(state, position=moved))


__all__ = [
    "DynamicsError",
    "NotSettled",
    "Solution",
    "continue_solution",
    "loaded_states",
    "rest_state",
    "solve_scene",
]
