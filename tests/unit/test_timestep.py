"""Time steps that are too long are refused, and the safe one is safe."""

import pytest
from small_scenes import scene

from granular_response.solve import Dynamics, DynamicsError, Problem, Stop, UnstableTimeStep, relax, solve_scene
from granular_response.solve.timestep import oscillator_limit, resolve_time_step, stability_limit


def test_unstable_time_step_is_one_clear_line():
    message = r"^protocol\.time_step: 0\.01 is unstable .*must be at most .*auto$"
    with pytest.raises(UnstableTimeStep, match=message) as error:
        solve_scene(scene(protocol__time_step=0.01))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "gear"])
def test_limit_separates_steps_that_settle_from_steps_that_do_not(integrator):
    problem = Problem.from_scene(scene(protocol__integrator=integrator))
    limit = stability_limit(problem)
    safe = Problem.from_scene(scene(protocol__integrator=integrator, protocol__time_step="auto"))
    assert resolve_time_step(safe) < limit

    def settles(step: float) -> bool:
        dynamics = Dynamics(problem, problem.bare_state(), integrator, step)
        try:
            return relax(dynamics, Stop(1e-12, maximum_steps=40_000)).information["settled"]
        except DynamicsError:
            return False

    assert settles(0.9 * limit)
    assert not settles(2.5 * limit)


def test_undamped_limit_of_verlet_is_two_over_the_frequency():
    assert oscillator_limit("verlet", 100.0, 0.0) == pytest.approx(0.2, rel=1e-2)


def test_softer_disks_allow_longer_steps():
    soft = stability_limit(Problem.from_scene(scene(contact__normal_stiffness=300.0)))
    assert soft == pytest.approx(10**0.5 * stability_limit(Problem.from_scene(scene())), rel=1e-3)
