"""Conjugate gradients that even out what is out of balance between neighbours."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import scene, shaken

from granular_response.solve import Problem, energy, minimise, nested, rest_state
from granular_response.solve.equilibrium import external_force
from granular_response.solve.relaxation import relaxed
from granular_response.solve.system import StaticSystem


@pytest.fixture(scope="module")
def problem() -> Problem:
    return Problem.from_scene(scene(16, 65, contact__friction=0.0, contact__normal_stiffness=5e4))


@pytest.fixture(scope="module")
def rest(problem):
    return rest_state(problem)


def eased(problem, start, displacement, steps):
    """Energy, and rms force out of balance, before and after; and displacements after."""
    system = StaticSystem(problem, start)
    known, external = system.start(start), external_force(problem, 0.0)
    q = known.q + displacement
    found = relaxed(system, external, q, steps)
    trials = [system.trial(known, each) for each in (q, found)]
    values = [energy.energy(system, each, external) for each in trials]
    sizes = [float(np.sqrt(np.mean((each.contact_force + external) ** 2))) for each in trials]
    return values, sizes, found


@pytest.mark.parametrize("changes", [{}, {"packing__polydispersity": 0.2, "contact__law": "hertz"}])
def test_normal_forces_are_those_of_a_trial(changes):
    problem = Problem.from_scene(scene(6, 13, contact__friction=0.0, **changes))
    start = shaken(problem, spring=0.0)
    system = StaticSystem(problem, start)
    known = system.start(start)
    assert system.normal_forces(known.q) == pytest.approx(system.trial(known, known.q).contact_force, abs=1e-11)


def test_what_is_of_short_range_goes_within_a_few_steps(problem, rest):
    noise = np.random.default_rng(0).normal(0.0, 1e-6, 2 * problem.n)
    (before, after), (unbalanced, left), _ = eased(problem, rest, noise, 40)
    assert after < before
    assert left < 0.05 * unbalanced


def test_what_is_of_long_range_stays(problem, rest):
    """A stretch over the whole slab: forces, which are small then, are no smaller where nothing is of short range."""
    x, z = rest.position.T
    stretch = 1e-5 * np.concatenate([0.0 * x, z / z.max()])
    _, _, found = eased(problem, rest, stretch, 5)
    assert found == pytest.approx(stretch, abs=4e-6)


def test_nothing_happens_in_equilibrium_and_without_a_step(problem, rest):
    _, (_, left), found = eased(problem, rest, np.zeros(2 * problem.n), 20)
    assert left < 1e-10
    assert np.abs(found).max() < 1e-12
    noise = np.random.default_rng(1).normal(0.0, 1e-6, 2 * problem.n)
    _, _, found = eased(problem, rest, noise, 0)
    assert np.array_equal(found, noise)


def test_a_descent_with_and_without_relaxation_finds_the_same_minimum(problem, rest, monkeypatch):
    noise = np.random.default_rng(2).normal(0.0, 1e-4, rest.position.shape)
    start = problem.with_static_forces(replace(rest, position=rest.position + noise))
    monkeypatch.setattr(energy, "LARGE", 0)
    found = minimise(problem, start)
    monkeypatch.setattr(energy, "RELAXATION", 0)
    without = minimise(problem, start)
    for state in (found, without):
        assert state.position == pytest.approx(rest.position, abs=1e-9)
        assert state.certificate.negative_modes == 0


def test_a_start_from_half_the_slab_is_nearer_to_equilibrium(monkeypatch):
    problem = Problem.from_scene(scene(24, 97, contact__friction=0.0, contact__normal_stiffness=1.2e5))
    monkeypatch.setattr(nested, "LARGE", 300)
    unbalanced = {}
    for steps in (0, nested.RELAXATION):
        monkeypatch.setattr(nested, "RELAXATION", steps)
        start = nested.rest_start(problem)
        system = StaticSystem(problem, start)
        known = system.start(start)
        left = system.trial(known, known.q).contact_force + external_force(problem, 0.0)
        unbalanced[steps] = float(np.sqrt(np.mean(left**2)))
    before, after = unbalanced.values()
    assert after < 0.2 * before
