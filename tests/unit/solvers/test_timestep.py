"""Time steps that are too long are refused, and the safe one is safe."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene
from granular_response.scene.protocol import PAPERS_TIME_STEP
from granular_response.solvers.dynamics import Dynamics, DynamicsError
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.solvers.timestep import (
    oscillator_limit,
    resolve_time_step,
    stability_limit,
    time_step_reason,
)
from granular_response.store.result import to_dataset


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "gear"])
def test_a_spring_advanced_by_the_predicted_velocity_allows_shorter_steps_than_one_on_the_position(integrator):
    """Without much damping; with it the dashpot decides."""
    stiffness, light, strong = 1.0, 0.05, 5.0
    assert oscillator_limit(integrator, 0.0, light, stiffness) < 0.85 * oscillator_limit(integrator, stiffness, light)
    assert oscillator_limit(integrator, 0.0, strong, stiffness) == pytest.approx(
        oscillator_limit(integrator, stiffness, strong), rel=0.05
    )


def test_leapfrog_bears_twice_the_step_and_its_tangential_springs_follow_positions():
    """Dashpots and tangential springs see the displacement of a step, over the step."""
    assert oscillator_limit("leapfrog", 0.0, 5.0, 1.0) > 1.9 * oscillator_limit("verlet", 0.0, 5.0, 1.0)
    for damping in (0.0, 0.05, 5.0):
        assert oscillator_limit("leapfrog", 0.0, damping, 1.0) == pytest.approx(
            oscillator_limit("leapfrog", 1.0, damping), rel=1e-3
        )
    slab = Problem.from_scene(scene(packing__polydispersity=0.25))
    assert stability_limit(slab, "leapfrog") > 1.9 * stability_limit(slab, "verlet")


def twisted(integrator: str, part: float) -> float:
    """Energy of a disk whose contact with the floor sticks while it twists there, per its energy at the start."""
    problem, state = free_disks(
        [[5.0, 1.0]], contact__friction=0.0, wall__friction=1e6, wall__damping_ratio=0.01, wall__stiffness_ratio=1.0
    )
    down = state.position - [[0.0, 1.0 / 6000.0]]
    state = replace(state, position=down, velocity=np.array([[1e-6, 0.0]]), angular_velocity=np.array([2e-6]))
    law = problem.wall_law
    step = part * oscillator_limit(integrator, 0.0, 3 * law.tangential_damping, 3 * law.tangential_stiffness)
    dynamics = Dynamics(problem, state, integrator, step)
    dynamics.set_ramps()
    before = dynamics.kinetic_energy()
    try:
        dynamics.advance(60)
    except DynamicsError:  # blown up
        return np.inf
    return dynamics.kinetic_energy() / before


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_the_limit_of_a_tangential_spring_is_the_kernels_own(integrator):
    """Rolling translates and turns the disk: (1 + 2) k_T over the mass is the rate of that one motion."""
    assert twisted(integrator, 0.97) < 1e-3
    assert twisted(integrator, 1.05) > 10.0


def test_the_step_is_safe_where_small_disks_gather():
    """In a poured packing; with the paper's step, near the limit of equal disks, small ones that touch never rest."""
    poured = Scene.from_dict({"packing": {"kind": "poured", "disks": 100, "width": 18.0, "sizes": [1.0, 1.4]}})
    problem = Problem.from_scene(poured)
    assert stability_limit(problem) > PAPERS_TIME_STEP > stability_limit(problem, smallest=True)
    assert resolve_time_step(problem) == pytest.approx(0.6 * stability_limit(problem, smallest=True))
    assert time_step_reason(problem).startswith("auto")
    slab = Problem.from_scene(scene(packing__polydispersity=0.25))
    assert resolve_time_step(slab) == PAPERS_TIME_STEP and time_step_reason(slab) == "the paper's"


def test_a_light_disk_on_a_stiff_floor_shortens_the_step():
    """Its own mass on the springs of the wall: with its neighbours' alone it never came to rest."""
    own = {"kind": "arrays", "x": [1.0, 3.0, 5.0], "z": [1.0] * 3, "radius": [1.0] * 3, "mass": [1.0, 0.05, 1.0]}
    described = {"packing": {**own, "width": 6.5}, "contact": {"friction": 0.0, "normal_stiffness": 300.0}, "loads": []}
    soft, stiff = (Scene.from_dict({**described, "wall": {"normal_stiffness": k}}) for k in (600.0, 6e4))
    assert stability_limit(Problem.from_scene(stiff)) < 0.5 * stability_limit(Problem.from_scene(soft))
    solution = solve_scene(stiff)
    data = to_dataset(solution)
    assert solution.rest.certificate.stable
    assert data.attrs["time_step"].startswith("auto: 0.6 of the stability limit, as")
    assert float(data["reached_time_step"][0]) == resolve_time_step(solution.problem) < PAPERS_TIME_STEP


@pytest.mark.parametrize(("given", "reason"), [(4e-4, "protocol.time_step"), ("auto", "auto: 0.6")])
def test_a_result_says_which_time_step_was_taken(given, reason):
    solution = solve_scene(scene(protocol__time_step=given))
    data = to_dataset(solution)
    assert data.attrs["time_step"].startswith(reason) and 0.0 < float(data["reached_time_step"][0]) < 1e-3
    assert given == "auto" or float(data["reached_time_step"][0]) == given
