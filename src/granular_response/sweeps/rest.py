"""Rest states that studies share: a packing of one material is settled once in the whole pipeline.

A rest state depends on the packing, the contact laws, the preparation and the numerics that settle it, not on the
loads that follow. ``rest_state`` keeps each one under a name made from just these, in the folder ``rest_states`` of the
:mod:`.resources` in use (without one nothing is kept). States are exact copies, so a study gives the same bytes
whether it finds a state or computes it.
"""

from __future__ import annotations

import os
from contextlib import suppress

from ..scene import Scene
from ..solvers import solution as solvers
from ..solvers.problem import Problem
from ..solvers.timestep import UnstableTimeStep, resolve_time_step
from ..state import State
from .keys import key
from .memory import Memory
from .resources import current

#: The code that settles a packing.
_PARTS = ("contact", "kernels", "linalg", "machine", "scene", "solvers", "state")


def rest_state(problem: Problem) -> State:
    """The certified state at rest under gravity, kept or computed; see ``solvers.solution.rest_state``.

    Raises what that raises. A kept state that cannot be read counts as none.
    """
    folder = current().rest_states
    if folder is None:
        return solvers.rest_state(problem)
    memory, kept = Memory(folder, _PARTS, states=True), name(problem)
    state = memory.load(kept)
    if isinstance(state, State):
        return state
    if not os.path.isdir(memory.shelf):  # the first one of these sources
        memory.clear()
    state = solvers.rest_state(problem)
    memory.save(kept, state)
    return state


def rest_of(scene: Scene) -> State:
    """The same of a scene."""
    return rest_state(Problem.from_scene(scene))


def name(problem: Problem) -> str:
    """Equal for problems with the same rest state."""
    packing, protocol = problem.packing, problem.scene.protocol
    method = problem.plan.rest.method
    numerics: tuple = ()
    preparation = problem.scene.preparation
    # a packing prepared without friction may turn away once it has it, however it was prepared; taps are motion
    if method == "dynamics" or preparation.taps or (problem.rotations and preparation.gravity == "frictionless"):
        step: float | str | None = protocol.time_step
        with suppress(UnstableTimeStep):  # whoever needs a stable one will refuse it
            step = resolve_time_step(problem)
        numerics = (
            protocol.integrator,
            step,
            problem.plan.stop_energy,
            problem.plan.stop_acceleration,
            problem.plan.larger_steps,
            protocol.stop_rule,
            protocol.maximum_steps,
            protocol.static_finish,
        )
    return key(packing, problem.laws, problem.rule, preparation, method, numerics)
