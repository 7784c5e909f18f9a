"""Contacts take energy and never give any."""

import numpy as np
import pytest
from small_scenes import free_disks, scene

from granular_response.contact import LAWS
from granular_response.solve import Dynamics, NotSettled, Problem, Stop, relax, solve_scene
from granular_response_paper.trials.closed_forms import collision, mechanical_energy


@pytest.mark.parametrize("damping_ratio", [0.0, 0.5])
@pytest.mark.parametrize("friction", [0.2, 1.0])
def test_frictional_wall_gives_no_energy_at_any_incidence(friction, damping_ratio):
    """From grazing to head-on, with and without spin."""
    for angle in np.radians([2.0, 5.0, 15.0, 30.0, 45.0, 60.0, 80.0, 88.0]):
        for spin in (-2.0, 0.0, 2.0):
            problem, state = free_disks(
                [[500.0, 1.01]],
                velocity=[(np.cos(angle), -np.sin(angle))],
                spin=[spin],
                contact__friction=0.0,
                wall__friction=friction,
                wall__damping_ratio=damping_ratio,
            )
            dynamics = Dynamics(problem, state, "beeman", 1e-4)
            dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
            before = dynamics.kinetic_energy()
            dynamics.advance(round((0.02 / np.sin(angle) + 0.2) / 1e-4))
            assert dynamics.v[1] > 0 and not dynamics.touching().any()  # it has bounced
            assert dynamics.v[0] != pytest.approx(np.cos(angle))
            assert dynamics.kinetic_energy() <= before * (1.0 + 1e-4)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("damping_ratio", [0.0, 0.5])
@pytest.mark.parametrize("pair", [False, True], ids=["floor", "pair"])
def test_no_collision_gives_energy_under_any_law(pair, damping_ratio, law):
    for friction in (0.2, 1.0):
        changes = {"contact__friction": friction, "contact__damping_ratio": damping_ratio, "contact__law": law}
        one = scene(**changes, wall__friction=friction, wall__damping_ratio=damping_ratio)
        for angle in (2.0, 15.0, 45.0, 80.0, 90.0):
            for spin in (-2.0, 0.0, 2.0):
                left = collision(one, angle, spin, 1e-4, pair=pair)
                assert 0.0 < left <= 1.0 + 1e-4
                if damping_ratio and angle == 90.0:
                    assert left < 0.9


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_falling_packing_loses_energy_all_the_time(friction, law):
    changes = {"contact__friction": friction, "wall__friction": friction, "contact__law": law}
    problem = Problem.from_scene(scene(**changes))
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", 1e-4)
    energy = [mechanical_energy(dynamics)]
    for _ in range(100):
        dynamics.advance(200)
        energy.append(mechanical_energy(dynamics))
    assert np.diff(energy).max() < 1e-6
    assert energy[0] - energy[-1] > 1e-3


@pytest.mark.parametrize("law", LAWS)
def test_undamped_frictionless_packing_keeps_its_energy(law):
    undamped = {"contact__friction": 0.0, "contact__damping_ratio": 0.0, "wall__damping_ratio": 0.0}
    problem = Problem.from_scene(scene(**undamped, contact__law=law))
    start = problem.bare_state()
    drift = []
    for step in (4e-4, 1e-4):
        dynamics = Dynamics(problem, start, "verlet", step)
        before = mechanical_energy(dynamics)
        dynamics.advance(round(2.0 / step))
        drift.append(abs(mechanical_energy(dynamics) - before))
    assert drift[1] < 1e-4
    assert drift[1] < 0.5 * drift[0]


def test_literal_friction_rule_never_settles_and_says_so():
    """The spring frozen beyond the limit keeps disks turning: flagged by ``relax``, an error from ``solve_scene``."""
    literal = scene(protocol__friction_law="literal", protocol__maximum_steps=40_000)
    problem = Problem.from_scene(literal)
    state = relax(Dynamics(problem, problem.bare_state()), Stop(1e-13, maximum_steps=40_000))
    assert state.reached.settled is False
    assert state.reached.kinetic_energy > 1e-9
    with pytest.raises(NotSettled, match=r"did not come to rest under gravity within protocol\.maximum_steps = 40000"):
        solve_scene(literal)
    unfinished = solve_scene(literal.updated({"protocol.static_finish": False}))
    assert unfinished.rest.reached.settled is False
    # the rule that is used by default settles in the same time, and so does a frozen spring that is free to unload
    for law in ("cut", "unloading"):
        other = Problem.from_scene(scene(protocol__friction_law=law))
        assert relax(Dynamics(other, other.bare_state()), Stop(1e-13, maximum_steps=40_000)).reached.settled
