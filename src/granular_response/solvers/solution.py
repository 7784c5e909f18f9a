"""A solved scene: its state at rest and under load."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..contact import Linear
from ..errors import EquilibriumError, require
from ..scene import Scene, SceneError
from ..scene.errors import show
from ..scene.given import finite_numbers
from ..state import MOVED_FAR, FloatArray, State
from .choice import Choice
from .dynamics import Dynamics, Stop, relax
from .energy import minimise
from .equilibrium import certify, check_overlaps, finish, reaction
from .idle import idle_settings
from .overlaps import overlap_at_start
from .path import follow
from .path.events import lost, side
from .problem import Problem
from .settle import PROTOCOL, NotSettled, not_settled, settle
from .size import check_memory
from .taps import tapped
from .timestep import long_fall, resolve_time_step

#: Load that the contacts of one disk bear at most without an overlap of a radius, over the stiffness of one.
MOST_BORNE = 4.0

#: Longest step of a displaced disk between two minimisations (mean radii).
LONGEST_WAY = 0.1

#: Displacement from a minimum to the next, beyond the way of what is held, from which on the packing has snapped (mean
#: radii); the elastic displacements of the paper's loads are below some hundredths.
SNAPPED = 0.1

#: Part of a response that may be rounding, from which on that is said.
ROUNDED = 1e-3

#: Distance from its given place (mean radii) from which on it is said that a disk has moved.
FAR_FROM_GIVEN = 0.5

#: Distance from which on it is said that a packing that was given with its springs was not at rest; what LAMMPS left
#: there moves by 2e-6 at most.
NOT_AT_REST = 1e-4

#: Reaction (mean disk weights) up to which a displaced disk counts as free of force.
BALANCED = 1e-8

#: Called as ``progress(done, total, what)``.
Progress = Callable[[float, float, str], None]


@dataclass(frozen=True)
class Solution:
    """Rest state and loaded states of a scene.

    ``problem`` has its loads on disks; ``loaded`` holds one state for each step of the load programme, in order
    (empty for a scene without loads).
    """

    scene: Scene
    problem: Problem
    rest: State
    loaded: tuple[State, ...]

    @property
    def rest_choice(self) -> Choice:
        """How the rest state was found, and why so."""
        return self.problem.plan.rest

    @property
    def load_choice(self) -> Choice | None:
        """How the loaded states were found, and why so; None without loads."""
        return self.problem.plan.load if self.loaded else None

    @property
    def load_factors(self) -> tuple[float, ...]:
        """Multipliers of the scene's loads that the loaded states have reached."""
        return tuple(state.load_factor for state in self.loaded)

    @property
    def rounding(self) -> float:
        """How much of a response may be no more than rounding.

        Forces out of balance and what the last digit of a position is worth as a force, over the smallest load, of
        which a torque counts as a force at one radius.
        """
        torque = float(np.abs(self.problem.load[:, 2]).sum())
        loads = [self.applied_force(one) + abs(one.load_factor) * torque for one in self.loaded if one.load_factor]
        if not loads or min(loads) <= 0.0:
            return 0.0
        stiffness = max(self.problem.stiffness, self.problem.wall_law.normal_stiffness)
        digit = 0.5 * float(np.spacing(np.abs(self.rest.position).max())) * stiffness
        residual = max(s.certificate.force_residual for s in (self.rest, *self.loaded))
        return max(residual, digit) / min(loads)

    @property
    def remarks(self) -> list[str]:
        """What whoever asked must know: settings without effect, states that still move, digits that are lost."""
        part, rounded = self.rounding, ""
        if part > ROUNDED:
            rounded = f"up to {part:.1g} of the response to the smallest load may be rounding; take larger loads"
        plan, states = self.problem.plan, (self.rest, *self.loaded)
        out, uncertified = max(state.certificate.unbalanced_part for state in states), ""
        if self.scene.protocol.static_finish and not plan.static and not all(s.certificate.balanced for s in states):
            uncertified = (
                f"not certified: up to {out:.1g} of what a disk bears is out of balance ({plan.rest.reason}); "
                "take a smaller protocol.stop_kinetic_energy"
            )
        idle = idle_settings(self.problem.scene, plan, rotations=self.problem.rotations)
        lines = (*idle, self.unsettled or uncertified or rounded, self.displaced)
        return [line for line in lines if line]

    @property
    def displaced(self) -> str:
        """That given disks are no longer near where they were given, in one line; empty where all are."""
        moved = self.problem.packing.moved(self.rest.position)
        springs = self.problem.packing.contacts is not None
        if moved is None or not moved.max() > (NOT_AT_REST if springs else FAR_FROM_GIVEN):
            return ""
        disk = int(moved.argmax())
        if springs:
            return (
                f"disk {disk} comes to rest {moved[disk]:.2g} mean radii from where it was given: with packing.springs "
                "disks must be at rest under gravity alone, with the contact law of the scene"
            )
        cure = overlap_at_start(self.problem) or "are they whole, and do floor and walls stand where they did?"
        return (
            f"disk {disk} comes to rest {moved[disk]:.2g} mean radii from where it was given, half of the disks "
            f"move by more than {np.median(moved):.2g}; {cure}"
        )

    @property
    def unsettled(self) -> str:
        """Which states are still moving, in one line; empty when all are at rest."""
        steps = self.scene.protocol.maximum_steps
        moving = [
            f"load factor {state.load_factor:g}" if k else "gravity"
            for k, state in enumerate([self.rest, *self.loaded])
            if state.reached.settled is False
        ]
        return f"not at rest within protocol.maximum_steps = {steps}: {', '.join(moving)}" if moving else ""

    @property
    def total_force(self) -> float:
        """Sum of the magnitudes of the forces of the loads at load factor 1, reactions left out."""
        return float(np.hypot(self.problem.load[:, 0], self.problem.load[:, 1]).sum())

    def reaction(self, state: State) -> FloatArray:
        """(l, 2) force with which each load holds its disk, 0 along directions that are free (mean disk weights)."""
        return reaction(self.problem, state)

    def applied_force(self, state: State) -> float:
        """Sum of the magnitudes of the forces of the loads in a state, with reactions that are more than rounding."""
        if len(self.problem.held) == 0:
            return abs(state.load_factor) * self.total_force
        forces = state.load_factor * self.problem.load[:, :2] + self.reaction(state)
        size = float(np.hypot(forces[:, 0], forces[:, 1]).sum())
        return size if size > BALANCED else 0.0


def solve_scene(
    scene: Scene, *, load_factors: Sequence[float] | None = None, progress: Progress | None = None
) -> Solution:
    """Settle a scene under gravity, then take it through its load programme.

    Parameters
    ----------
    scene : what to solve.
    load_factors : multipliers of the scene's loads, in turn, growing or falling; those of the protocol if None.
    progress : called with the part done of a stage, 1 and the stage's name.

    Raises
    ------
    SceneError, NotSettled, DynamicsError, EquilibriumError, PathError
        Each with one line that says what to change.
    """
    if load_factors is not None:  # what is stored is the scene that was solved
        scene = scene.updated({"protocol.load_factors": load_programme(load_factors)})
    factors = scene.protocol.load_factors
    problem = checked_problem(scene)
    rest = rest_state(problem, progress=progress)
    problem = problem.with_loads(rest.position)
    states = loaded_states(problem, rest, factors, progress=progress)[1] if scene.loads else []
    for state in (rest, *states):
        check_overlaps(problem, state)
    return Solution(scene, problem, rest, tuple(states))


def checked_problem(scene: Scene) -> Problem:
    """The problem of a scene, once all is refused that can be before anything moves.

    Raises
    ------
    SceneError
        For a packing or a load that is not allowed, too many disks for the memory, or a method that is none for it.
    """
    rule = f"{scene.motion.key}: must be left out, equilibria are found from rest; gr.motion follows it"
    require(not scene.motion.key, rule, SceneError)
    check_memory(scene, scene.packing.disk_count)
    problem = Problem.from_scene(scene)
    check_memory(scene, problem.n)  # a file's disks are counted by now
    _check_loads(problem.with_loads(problem.packing.position), scene.protocol.load_factors)
    return problem


def _check_loads(problem: Problem, factors: Sequence[float]) -> None:
    """Refuse, before the packing settles, what no packing can bear; disks of loads have been found by now."""
    if not isinstance(problem.pair_law, Linear):
        return
    most = MOST_BORNE * max(problem.stiffness, problem.wall_law.normal_stiffness)
    for k, force in enumerate(np.hypot(problem.load[:, 0], problem.load[:, 1]) * np.abs(factors).max()):
        if force > most:
            raise SceneError(
                f"loads[{k}].force: {force:.3g} mg at the largest load factor, must be at most {most:.3g}, "
                "under which contacts of this stiffness overlap by a radius"
            )


def continue_solution(
    solution: Solution, load_factors: Sequence[float], *, progress: Progress | None = None
) -> Solution:
    """The solution with states at further ``load_factors``, as if they had been asked for from the beginning.

    They may grow or fall. The new states have the bits of a run that was never cut, but for dynamics with a law whose
    stiffness grows with the load: its time step, if ``auto``, is the one that the loads up to here ask for.

    Raises
    ------
    SceneError
        When the scene has no loads, or the factors are none, not finite or more than its contacts bear.
    NotSettled, DynamicsError, EquilibriumError, PathError
        As of ``solve_scene``.
    """
    require(solution.loaded, "loads: none in this scene, so there is nothing to change", SceneError)
    factors = load_programme(load_factors)
    scene = solution.scene.updated({"protocol.load_factors": [*solution.scene.protocol.load_factors, *factors]})
    problem = replace(solution.problem, scene=scene)
    _check_loads(problem, factors)
    _, states = loaded_states(problem, solution.rest, factors, before=solution.loaded, progress=progress)
    for state in states:
        check_overlaps(problem, state)
    return replace(solution, scene=scene, problem=problem, loaded=(*solution.loaded, *states))


def load_programme(factors: Any) -> list[float]:
    """A load programme as numbers; raises ``SceneError`` when it is anything but one or more that are finite."""
    programme = finite_numbers(factors)
    if not programme:
        raise SceneError(f"load factors {show(factors)}: must be a list of one or more finite numbers")
    return programme


def rest_state(problem: Problem, *, progress: Progress | None = None) -> State:
    """The certified state at rest under gravity, prepared as the scene says."""
    rest, taps = _under_gravity(problem, progress), problem.scene.preparation.taps
    if taps is None:
        return rest
    rule = "preparation.taps: must be null, each tap ends in an equilibrium, and statics is left out here"
    require(problem.plan.static, rule, SceneError)
    return tapped(problem, rest, taps.number, taps.amplitude, taps.duration)


def _under_gravity(problem: Problem, progress: Progress | None) -> State:
    """The same before any taps."""
    if problem.rotations and problem.scene.preparation.gravity == "frictionless":
        smooth = _under_gravity(problem.without_friction(), progress)
        # no tangential spring is stretched: an equilibrium with friction too
        start = problem.with_static_forces(smooth)
        try:
            found = finish(problem, start)
        except EquilibriumError:
            if smooth.reached.settled is False:  # statics is not what failed
                raise NotSettled(not_settled(problem, smooth, "gravity without friction")) from None
            raise
        if found.certificate.stable or not problem.plan.static:
            return found
        # contacts that touch without bearing may open in the last digit, and what they held turns away
        return _relaxed(problem, start, "gravity", progress)
    if problem.plan.rest.method == "minimise":
        return minimise(problem, problem.bare_state())
    preparation = problem.scene.preparation
    slow = preparation.gravity == "slow"
    gravity = (0.0, 1.0, preparation.ramp_time) if slow else (1.0, 1.0, 0.0)
    return _relaxed(problem, problem.bare_state(), "gravity", progress, gravity=gravity)


def loaded_states(
    problem: Problem,
    rest: State,
    load_factors: Sequence[float],
    *,
    before: Sequence[State] = (),
    progress: Progress | None = None,
) -> tuple[Choice, list[State]]:
    """States at ``load_factors`` in turn, growing or falling, and the method that found them.

    ``before`` : states that the programme has reached already, from ``rest`` on. A path and minimisation go on
    from the last state through every load between. Dynamics ramps the load from rest to each factor anew, as the
    paper does, as long as the programme has led away from the rest state's load all the time; from its first turn
    on, each ramp starts from the state before.
    """
    choice = problem.plan.load
    factors = [float(f) for f in load_factors]
    if choice.method == "path":
        return choice, _on_path(problem, [rest, *before][-1], factors, progress)
    states = [rest, *before]
    for done, factor in enumerate(factors, 1):
        if choice.method == "dynamics":
            moves = np.diff([*(state.load_factor for state in states), factor])
            turned = moves.min() < 0.0 < moves.max()
            states.append(_by_dynamics(problem, states[-1] if turned else rest, factor, progress))
            continue
        states.append(_by_minimisation(problem, states[-1], factor, progress))
        if progress is not None:
            progress(done, len(factors), "load")
    return choice, states[1 + len(before) :]


def _by_minimisation(problem: Problem, before: State, factor: float, progress: Progress | None) -> State:
    start = before
    way = float(np.abs(problem.held.travel).max(initial=0.0)) * abs(factor - before.load_factor)
    try:
        # what is held goes its way in short steps, so that it meets what is on it
        for part in np.linspace(before.load_factor, factor, math.ceil(way / LONGEST_WAY) + 1)[1:-1]:
            before = problem.relisted(minimise(problem, before, load_factor=float(part)))
        found = minimise(problem, before, load_factor=factor)
        moved = found.position - start.position
        snapped = float(np.hypot(*moved.T).max()) > SNAPPED + way
        if not (found.reached.escapes or snapped):
            return found
        kind, why = ("bifurcation", "unstable") if found.reached.escapes else ("jump", MOVED_FAR)
        left = lost(kind, start.load_factor, factor, start.position, moved, f"{why}, to the {side(moved)}")
        return replace(found, reached=replace(found.reached, events=(left,)))
    except EquilibriumError:
        # the packing collapses or rearranges here: its motion decides where it comes to rest
        state = _by_dynamics(problem, before, factor, progress)
        moved = state.position - before.position
        reason = f"no minimum of the energy nearby, to the {side(moved)}"
        jump = lost("jump", before.load_factor, factor, before.position, moved, reason)
        return replace(state, reached=replace(state.reached, events=(jump,)))


def _on_path(problem: Problem, start: State, factors: Sequence[float], progress: Progress | None) -> list[State]:
    whole = float(np.abs(np.diff([start.load_factor, *factors])).sum())
    done = 0.0
    last = start.load_factor

    def report(factor: float) -> None:
        nonlocal done, last
        done, last = done + abs(factor - last), factor
        if progress is not None:
            progress(done, whole, "load")

    return follow(problem, start, factors, progress=report)


def _by_dynamics(problem: Problem, start: State, factor: float, progress: Progress | None) -> State:
    load = (start.load_factor, factor, problem.scene.protocol.ramp_time)
    return _relaxed(problem, start, "load", progress, load=load)


def _relaxed(problem: Problem, start: State, stage: str, progress: Progress | None, **ramps: Any) -> State:
    """Dynamics to rest as the protocol says, and the static finish; ``ramps`` of gravity and load."""
    protocol = problem.scene.protocol
    stop, fall = Stop.of(problem), stage == "gravity"
    report = None
    if progress is not None:
        limit, what = stop.acceleration or stop.kinetic_energy, stage + (long_fall(problem) if fall else "")
        highest, done = limit * 10.0, 0.0

        def report(_: Dynamics, left: float) -> None:
            nonlocal highest, done
            if math.isfinite(left):
                highest = max(highest, left)
                done = max(done, math.log(highest / max(left, limit)) / math.log(highest / limit))
            progress(done, 1.0, what)

    if problem.plan.static:
        return settle(problem, start, PROTOCOL, stop, what=stage, fall=fall, progress=report, **ramps)
    dynamics = Dynamics(problem, start, protocol.integrator, resolve_time_step(problem))
    settled = relax(dynamics, stop, progress=report, **ramps)
    if protocol.static_finish and not settled.reached.settled:
        raise NotSettled(not_settled(problem, settled, stage))
    return replace(settled, reached=replace(settled.reached, certificate=certify(problem, settled)))
