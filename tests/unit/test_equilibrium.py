"""Static finish and certificates."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene, shaken

from granular_response.errors import EquilibriumError
from granular_response.solvers.equilibrium import certify, external_force, finish, newton
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.solvers.system import StaticSystem
from granular_response.state import SLIDING


@pytest.fixture(scope="module")
def settled():
    problem = Problem.from_scene(scene(wall__friction=0.2))
    return problem, rest_state(problem)


def test_finish_of_a_finished_state_changes_nothing(settled):
    problem, rest = settled
    again = finish(problem, rest)
    assert again.position == pytest.approx(rest.position, abs=1e-13)
    assert again.pairs.spring == pytest.approx(rest.pairs.spring, abs=1e-13)


def test_finish_brings_a_displaced_state_back_to_balance(settled):
    problem, rest = settled
    rng = np.random.default_rng(0)
    moved = problem.with_static_forces(replace(rest, position=rest.position + rng.normal(0, 1e-6, (problem.n, 2))))
    assert certify(problem, moved).force_residual > 1e-4
    certificate = finish(problem, moved).certificate
    assert certificate.force_residual < 1e-10 and certificate.torque_residual < 1e-10
    assert certificate.stable


def test_finish_far_from_rest_is_an_error():
    problem = Problem.from_scene(scene())
    with pytest.raises(EquilibriumError, match="relax it further first"):
        finish(problem, shaken(problem, size=0.2))


def test_a_disk_of_which_all_contacts_slide_turns_by_no_more_than_a_contact_would_allow(settled):
    problem, rest = settled
    system = StaticSystem(problem, rest)
    known, disk = system.start(rest), int(np.argmax(rest.position[:, 1]))
    touches = ((system.first == disk) | (system.second == disk)) & (rest.pairs.overlap > 0.0)
    turned = known.q.copy()
    turned[2 * problem.n + disk] += 2.0 * problem.pair_law.friction / problem.pair_law.tangential_stiffness
    trial = system.trial(known, turned)
    assert (np.abs(trial.sense[: len(touches)][touches]) == SLIDING).all()
    left = trial.contact_force + external_force(problem, 0.0)
    step = system.step(trial, left)
    assert 0.0 < np.abs(step[2 * problem.n + disk]) < 10.0 * np.abs(left).max() / problem.stiffness


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_disk_that_nothing_touches_falls_to_its_support_in_few_steps(friction):
    """Only angles are held: a disk in the air is not."""
    problem, state = free_disks([[500.0, 1.02], [510.0, 1.0]], contact__friction=friction, wall__friction=friction)
    system = StaticSystem(problem, problem.relisted(state))
    trial, report = newton(system, system.start(state), external_force(problem, 0.0))
    assert report.converged and report.iterations <= 5
    assert (trial.configuration.overlap > 0.0).all()


def test_certificate_measures_what_it_says(settled):
    """Each fault shows in its own number."""
    problem, rest = settled
    good = certify(problem, rest)
    assert good.force_residual < 1e-10 and good.kinetic_energy == 0 and good.coulomb_excess == 0
    c = int(np.argmax(rest.pairs.normal_force))
    normal, tangential = rest.pairs.normal_force.copy(), rest.pairs.tangential_force.copy()
    normal[c] += 0.01
    bad = certify(problem, replace(rest, pairs=replace(rest.pairs, normal_force=normal)))
    assert 0.007 < bad.force_residual <= 0.01 + 1e-9 and bad.torque_residual < 1e-10
    tangential[c] = 0.2 * rest.pairs.normal_force[c] + 0.5
    bad = certify(problem, replace(rest, pairs=replace(rest.pairs, tangential_force=tangential)))
    assert bad.coulomb_excess == pytest.approx(0.5)
    assert bad.torque_residual > 0.1
    velocity = np.zeros((problem.n, 2))
    velocity[3] = 0.3, 0.4
    spin = np.zeros(problem.n)
    spin[4] = 2.0
    moving = certify(problem, replace(rest, velocity=velocity, angular_velocity=spin))
    assert moving.kinetic_energy == pytest.approx((0.5 * 0.25 + 0.5 * 0.5 * 4.0) / problem.n)


def test_loads_count_in_the_balance():
    loads = [{"disk": 0, "force": [0.0, -1.0]}]
    problem, state = free_disks([[500.0, 1.0 - 3.0 / 6000.0]], contact__friction=0.0, loads=loads)
    problem = problem.with_loads(state.position)
    assert certify(problem, replace(state, load_factor=2.0)).force_residual < 1e-9
    assert certify(problem, replace(state, load_factor=1.0)).force_residual == pytest.approx(1.0)


def test_torques_count_in_the_balance():
    problem = Problem.from_scene(scene(loads=[{"disk": "top-centre", "force": [0.0, 0.0], "torque": 1.0}]))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    assert certify(problem, rest, modes=0).stable
    turned = certify(problem, replace(rest, load_factor=1.0), modes=0)
    assert turned.torque_residual == pytest.approx(1.0) and turned.unbalanced_part > 0.1
    assert not turned.balanced and turned.stable is False


def test_loose_disks_are_counted():
    problem, state = free_disks([[500.0, 1.0 - 1 / 6000.0], [510.0, 1.0 - 1 / 6000.0]])
    assert certify(problem, state).loose_disks == 2
