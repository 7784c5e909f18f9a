"""Which time steps settle, cycle or blow up, against the predicted limit.

A packing at rest is kicked, in raw dynamics with no guard on the step. The rest state is solved with a safe step. It is
then knocked about a little, so that contacts neither open nor slide at first: whether the kick dies out is the linear
stability of the integrator in this packing. Beyond the limit the motion grows until contacts open and slide, and either
goes on for ever or blows up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, DynamicsError
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states, rest_state
from granular_response.solvers.timestep import stability_limit
from granular_response.state import State

#: What becomes of a kick.
SETTLES, CYCLES, BLOWS_UP = 0, 1, 2
#: Largest velocity of the kick, in units of the mean overlap times the frequency of a contact.
KICK = 1e-3
#: Parts into which a run is divided to see whether the energy still falls.
PARTS = 8
#: Steps between two looks at whether it has blown up.
LOOK_EVERY = 100
#: A kick blows up when its energy reaches this multiple; it dies out when in the second half of the run the energy
#: stays below this part (an unstable mode saturates far above 1, a slow one may not fall much lower).
GROWN, FALLEN = 1e10, 0.3


def tried(scene: Scene, integrator: str, ratios: Sequence[float], steps: int, seed: int) -> list[int]:
    """What becomes of a kick at time steps that are ``ratios`` of the predicted limit."""
    problem = Problem.from_scene(scene)
    limit = stability_limit(problem, integrator)
    problem, state, load = prepared(problem)
    kicked = kick(problem, state, seed)
    return [outcome(problem, kicked, load, integrator, ratio * limit, steps) for ratio in ratios]


def prepared(problem: Problem) -> tuple[Problem, State, float]:
    """The packing at rest under its loads, and their factor; settled with the dashpots that settle it fastest."""
    scene = problem.scene
    damped = Problem.from_scene(
        scene.updated(
            {"contact.damping_ratio": 0.5, "wall.damping_ratio": 0.5, "protocol.integrator": "verlet",
             "protocol.maximum_steps": 400_000}
        )
    )  # fmt: skip
    state = rest_state(damped)
    problem, damped = problem.with_loads(state.position), damped.with_loads(state.position)
    if not scene.loads:
        return problem, state, 0.0
    return problem, loaded_states(damped, state, [1.0])[1][0], 1.0


def kick(problem: Problem, state: State, seed: int, part: float = KICK) -> State:
    """The state with random velocities and spins of the disks that bear anything, up to ``part`` of the unit above."""
    generator = np.random.default_rng(seed)
    overlap = float(np.mean(state.pairs.overlap[state.pairs.touching]))
    size = part * overlap * np.sqrt(problem.stiffness) * (state.contact_count() >= 2)
    return replace(
        state,
        velocity=size[:, None] * generator.uniform(-1.0, 1.0, state.velocity.shape),
        angular_velocity=size * generator.uniform(-1.0, 1.0, problem.n) * problem.rotations,
    )


def outcome(problem: Problem, kicked: State, load: float, integrator: str, step: float, steps: int) -> int:
    """Run ``steps`` time steps and look at the kinetic energy."""
    dynamics = Dynamics(problem, kicked, integrator, step)
    dynamics.set_ramps(load=(load, load, 0.0))
    start = dynamics.kinetic_energy(bearing_only=True)
    bearing = int(0.9 * (dynamics.contact_count() >= 2).sum())
    held = True  # once disks have come loose, theirs is what counts
    energy: list[float] = []
    part = steps // PARTS
    for _ in range(PARTS):
        for done in range(0, part, LOOK_EVERY):  # what has blown up lists its contacts anew at every step
            try:
                with np.errstate(over="ignore", invalid="ignore"):
                    dynamics.advance(min(LOOK_EVERY, part - done))
            except (DynamicsError, ValueError):
                return BLOWS_UP
            now = dynamics.kinetic_energy(bearing_only=held)
            if not now < GROWN * start:
                return BLOWS_UP
        held = held and int((dynamics.contact_count() >= 2).sum()) >= bearing
        energy.append(now)
    return SETTLES if max(energy[PARTS // 2 :]) < FALLEN * start else CYCLES
