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


@pytest.fixture(scope="module")
def settled():
    problem = Problem.from_scene(scene(wall__friction=0.2))
    return problem, rest_state(problem)


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


def test_torques_count_in_the_balance():
    problem = Problem.from_scene(scene(loads=[{"disk": "top-centre", "force": [0.0, 0.0], "torque": 1.0}]))
    rest = rest_state(problem)
    problem = problem.with_loads(rest.position)
    assert certify(problem, rest, modes=0).stable
    turned = certify(problem, replace(rest, load_factor=1.0), modes=0)
    assert turned.torque_residual == pytest.approx(1.0) and turned.unbalanced_part > 0.1
    assert not turned.balanced and turned.stable is False
