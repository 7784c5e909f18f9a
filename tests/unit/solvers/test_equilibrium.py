"""Static finish, certificates, increments of a path, and frictionless equilibria as minima of the energy."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refusals
from small_scenes import at_rest, free_disks, scene, shaken

from granular_response.errors import EquilibriumError
from granular_response.solvers import increment as module
from granular_response.solvers.energy import minimise
from granular_response.solvers.equilibrium import certify, external_force, finish, newton
from granular_response.solvers.increment import Work, solve_increment
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


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_disk_that_nothing_touches_falls_to_its_support_in_few_steps(friction):
    """Only angles are held: a disk in the air is not."""
    problem, state = free_disks([[500.0, 1.02], [510.0, 1.0]], contact__friction=friction, wall__friction=friction)
    system = StaticSystem(problem, problem.relisted(state))
    trial, report = newton(system, system.start(state), external_force(problem, 0.0))
    assert report.converged and report.iterations <= 5
    assert (trial.configuration.overlap > 0.0).all()


def test_certificate_measures_what_it_says(settled):
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


@pytest.fixture(scope="module")
def start():
    problem, rest = at_rest(scene(6, 13, loads=[{"disk": "top-centre", "force": [0.0, -1.0]}]))
    system = StaticSystem(problem, rest)
    return problem, system, system.start(rest)


def test_fixed_limits_lead_to_the_same_equilibrium(start, monkeypatch):
    """With no try on the true law at first, rounds of fixed limits must find what Newton's method finds."""
    problem, system, known = start
    external = external_force(problem, 0.5)
    direct = solve_increment(system, known, external, known.q, Work())
    solve = module.newton
    calls = []

    def refusing(*args, **options):
        calls.append(1)
        trial, report = solve(*args, **options)
        if len(calls) == 1:
            report = type(report)(False, report.iterations, report.residual)
        return trial, report

    monkeypatch.setattr(module, "newton", refusing)
    monkeypatch.setattr(module, "OPTIONS", replace(module.OPTIONS, again=5))
    work = Work()
    around = solve_increment(system, known, external, known.q, work)
    assert len(calls) == 2  # again after rounds of fixed limits
    assert around.configuration.q == pytest.approx(direct.configuration.q, abs=1e-11)
    assert np.array_equal(around.status, direct.status)
    calls.clear()
    monkeypatch.setattr(module, "OPTIONS", replace(module.OPTIONS, failed=0))
    assert solve_increment(system, known, external, known.q, Work()) is None


def rough() -> Problem:
    return Problem.from_scene(scene())


test_friction_has_no_energy_to_minimise = refusals(
    ValueError, (lambda: minimise(rough(), rough().bare_state()), "without friction")
)
test_where_there_is_no_equilibrium_it_is_said = refusals(
    EquilibriumError,
    (lambda: finish(rough(), shaken(rough(), size=0.2)), "relax it further first"),
    (lambda: minimise(*free_disks([[500.0, 1.0], [500.5, 1e5]], contact__friction=0.0)), "no minimum"),
)
