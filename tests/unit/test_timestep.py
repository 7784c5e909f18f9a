"""Time steps that are too long are refused, and the safe one is safe."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene

from granular_response.solve import Dynamics, DynamicsError, Problem, Stop, UnstableTimeStep, relax, solve_scene
from granular_response.solve.timestep import oscillator_limit, resolve_time_step, stability_limit, stage_time_step


def test_unstable_time_step_is_one_clear_line():
    message = r"^protocol\.time_step: 0\.01 is unstable .*must be at most .*auto$"
    with pytest.raises(UnstableTimeStep, match=message) as error:
        solve_scene(scene(protocol__time_step=0.01))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "leapfrog", "gear"])
def test_limit_separates_steps_that_settle_from_steps_that_do_not(integrator):
    problem = Problem.from_scene(scene(protocol__integrator=integrator))
    limit = stability_limit(problem)
    safe = Problem.from_scene(scene(protocol__integrator=integrator, protocol__time_step="auto"))
    assert resolve_time_step(safe) < limit

    def settles(step: float) -> bool:
        dynamics = Dynamics(problem, problem.bare_state(), integrator, step)
        try:
            return relax(dynamics, Stop(1e-12, maximum_steps=40_000)).reached.settled
        except DynamicsError:
            return False

    assert settles(0.9 * limit)
    assert not settles(2.5 * limit)


def test_undamped_limit_of_verlet_is_two_over_the_frequency():
    assert oscillator_limit("verlet", 100.0, 0.0) == pytest.approx(0.2, rel=1e-2)


def test_softer_disks_allow_longer_steps():
    soft = stability_limit(Problem.from_scene(scene(contact__normal_stiffness=300.0)))
    assert soft == pytest.approx(10**0.5 * stability_limit(Problem.from_scene(scene())), rel=1e-3)


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


@pytest.mark.parametrize(
    ("inertia", "damping", "gain"), [("rings", 1.0, 1.5), ("disks", 0.25, 2.0), ("rings", 0.25, 4.0)]
)
def test_stages_take_the_same_part_of_a_limit_that_is_further(inertia, damping, gain):
    scenes = scene(
        packing__polydispersity=0.25, protocol__integrator="leapfrog",
        protocol__inertia=inertia, protocol__stage_damping=damping,
    )  # fmt: skip
    disks = Problem.from_scene(scenes)
    staged = disks.in_stages()
    assert np.array_equal(staged.weight, disks.weight)
    if inertia == "rings":
        assert staged.inverse_mass == pytest.approx(
            np.concatenate([np.ones(2 * staged.n), staged.packing.radius**-2.0])
        )
    else:
        assert np.array_equal(staged.inverse_mass, disks.inverse_mass)
    for one, other in ((staged.pair_law, disks.pair_law), (staged.wall_law, disks.wall_law)):
        assert one == other._replace(
            normal_damping=damping * other.normal_damping, tangential_damping=damping * other.tangential_damping
        )
    longer = stability_limit(staged, smallest=True) / stability_limit(disks, smallest=True)
    assert longer > gain
    for step in ("auto", 2e-4):
        problem = replace(disks, scene=disks.scene.updated({"protocol.time_step": step}))
        assert stage_time_step(problem) == pytest.approx(longer * resolve_time_step(problem))


def test_stages_move_as_the_scene_says_unless_asked():
    problem = Problem.from_scene(scene(packing__polydispersity=0.25))
    staged = problem.in_stages()
    assert (staged.pair_law, staged.wall_law, staged.rings) == (problem.pair_law, problem.wall_law, False)
    assert stage_time_step(problem) == resolve_time_step(problem)


@pytest.mark.parametrize("damping", [1.0, 0.25])
def test_the_limit_of_stages_separates_steps_that_settle_from_steps_that_do_not(damping):
    problem = Problem.from_scene(
        scene(
            protocol__integrator="leapfrog",
            packing__polydispersity=0.1,
            protocol__inertia="rings",
            protocol__stage_damping=damping,
        )
    ).in_stages()
    limit = stability_limit(problem)

    def settles(step: float) -> bool:
        dynamics = Dynamics(problem, problem.bare_state(), "leapfrog", step)
        try:
            return relax(dynamics, Stop(1e-9, maximum_steps=40_000)).reached.settled
        except DynamicsError:
            return False

    assert settles(0.95 * limit)
    assert not settles(2.5 * limit)


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


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "leapfrog", "gear"])
def test_the_limit_of_a_tangential_spring_is_the_kernels_own(integrator):
    """Rolling translates and turns the disk: (1 + 2) k_T over the mass is the rate of that one motion."""
    assert twisted(integrator, 0.97) < 1e-3
    assert twisted(integrator, 1.05) > 10.0


def test_one_small_disk_shortens_the_step():
    positions = [[10.0, 1.0], [12.0, 1.0], [11.0, 2.8]]
    equal, _ = free_disks(positions)
    small, _ = free_disks(positions, radius=[1.3, 1.3, 0.4])
    assert stability_limit(small) < 0.6 * stability_limit(equal)
    slab = Problem.from_scene(scene(packing__polydispersity=0.25))
    assert stability_limit(slab) == stability_limit(Problem.from_scene(scene()))
