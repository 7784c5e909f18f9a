"""Stability of equilibria: closed forms, and complex pairs of eigenvalues of packings whose contacts slide."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import at_rest, free_disks, pushed, scene, started

from granular_response.solvers import stability
from granular_response.solvers.equilibrium import external_force, newton
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.stability import Clustered, Spectrum, divergence, diverging
from granular_response.solvers.system import StaticSystem
from granular_response.state import SLIDING


def balanced(places, radius, mass, **changes):
    """The equilibrium of smooth disks of given masses beside the given places."""
    problem, _ = free_disks(places, radius, contact__friction=0.0, wall__friction=0.0, **changes)
    problem = Problem.from_scene(problem.scene, replace(problem.packing, given_mass=np.array(mass)))
    state = problem.bare_state()
    system, known = started(problem, state)
    trial, report = newton(system, known, external_force(problem, 0.0))
    assert np.abs(trial.contact_force + external_force(problem, 0.0)).max() < 1e-12 and report.iterations
    return system, trial


@pytest.mark.parametrize("light", [1.0, 1e-1, 1e-3, 1e-5, 1e-7])
def test_a_disk_on_the_tip_of_another_is_unstable_whatever_it_weighs(light):
    """It leaves at sqrt(g / d) times the root of 1 + m / M, and moves as much more as it is lighter."""
    masses = np.array([1.0, light]) * 2.0 / (1.0 + light)  # their mean is 1
    # overlaps of the equilibrium, so that nothing is left to find
    floor, between = masses.sum() / 6000.0, masses[1] / 3000.0
    system, trial = balanced([(10.0, 1.0 - floor), (10.0, 3.0 - floor - between)], None, masses)
    assert Spectrum(system, trial).negative_modes == 1
    direction = Spectrum(system, trial).direction
    assert direction[0] / direction[1] == pytest.approx(-light, rel=1e-3)
    assert np.abs(direction).max() == 1.0
    assert divergence(Spectrum(system, trial)) is not None
    rate = masses[1] / 2.0 * (1.0 / masses).sum()
    matrix = system.tangent(trial).toarray() / system.interleave(1.0 / system.problem.inverse_mass)[:, None]
    assert np.linalg.eigvals(matrix).real.min() == pytest.approx(-rate, rel=1e-3)


@pytest.mark.parametrize("light", [1.0, 1e-3, 1e-7])
def test_a_disk_in_a_groove_is_stable_whatever_it_weighs(light):
    """Two disks between walls bear a third."""
    masses = np.array([1.0, 1.0, light])
    masses *= 3.0 / masses.sum()
    # nearly where they rest: pressed into floor, walls and each other by what they bear
    borne = masses[2] / np.sqrt(3.0)
    sunk, aside = (masses[0] + 0.5 * masses[2]) / 6000.0, 0.5 * borne / 6000.0
    apart = 2.0 - borne / 3000.0
    places = [(1.0 - aside, 1.0 - sunk), (3.0 + aside, 1.0 - sunk)]
    places.append((2.0, 1.0 - sunk + np.sqrt(apart**2 - (1.0 + aside) ** 2)))
    system, trial = balanced(places, None, masses, width=4.0)
    assert Spectrum(system, trial).negative_modes == 0
    assert divergence(Spectrum(system, trial)) is None


@pytest.mark.parametrize("radius, modes", [(3e5, 1), (3e6, 0)])
def test_what_grows_slower_than_a_thousandth_does_not_count_as_unstable(radius, modes):
    """A disk on the tip of a huge one leaves at the root of 2 g / d."""
    places = [(2.0 * radius, radius - 2.0 / 6000.0), (2.0 * radius, 2.0 * radius + 1.0 - 4.0 / 6000.0)]
    system, trial = balanced(places, [radius, 1.0], [1.0, 1.0], width=4.0 * radius)
    assert Spectrum(system, trial).negative_modes == modes


@pytest.mark.parametrize("aside, first", [(1e-5, 1.0), (-1e-5, -1.0), (1e-7, 1.0), (-1e-7, 1.0)])
def test_a_direction_leads_to_the_right_unless_rounding_alone_says_so(aside, first):
    low = 1.0 - 1.0 / 6000.0
    system, trial = balanced([(10.0, low), (20.0, low), (30.0, low)], None, [1.0, 1.0, 1.0])
    spectrum = Spectrum(system, trial)
    wanted = np.array([1.0, -0.5, aside - 0.5, 0.0, 0.0, 0.0])
    spectrum._followed = -1.0, system.interleave(wanted) / spectrum._scale
    assert spectrum.direction[0] == pytest.approx(first, abs=1e-4)


@pytest.mark.parametrize("high", [2, 3, 6])
def test_an_upright_column_has_an_unstable_direction_for_each_contact_between_disks(high):
    """It may move as a whole along a smooth floor, and bend in as many ways as it has joints."""
    system, trial = balanced([(10.0, 1.0 + 2.0 * k) for k in range(high)], None, np.ones(high))
    assert Spectrum(system, trial).negative_modes == high - 1
    loads = [{"disk": k, "displacement": [0.0, None]} for k in range(high)]
    held, state = free_disks(
        [(10.0, 1.0 + 2.0 * k) for k in range(high)], contact__friction=0.0, wall__friction=0.0, loads=loads
    )
    system = StaticSystem(held.with_loads(state.position), state)
    trial, _ = newton(system, system.start(state), external_force(system.problem, 0.0))
    assert Spectrum(system, trial).negative_modes == 0


def test_a_negative_eigenvalue_is_followed_where_it_is_still_negative(monkeypatch):
    system, trial = balanced([(10.0, 1.0), (10.0, 3.0)], None, np.ones(2))
    value, vector = Spectrum(system, trial).negative
    followed = Spectrum(system, trial, near=(1.01 * value, vector + 1e-3))
    assert followed.negative[0] == pytest.approx(value, rel=1e-6) and followed.negative_modes == 1
    assert np.abs(followed.direction) == pytest.approx(np.abs(Spectrum(system, trial).direction), abs=1e-6)
    lying, rest = balanced([(10.0, 1.0), (30.0, 1.0)], None, np.ones(2))
    stable = Spectrum(lying, rest, near=(value, vector))
    assert stable.negative_modes == 0 and stable.negative is None
    column = balanced([(10.0, 1.0), (10.0, 3.0), (10.0, 5.0)], None, np.ones(3))
    monkeypatch.setattr(stability, "lowest_real", lambda *_: None)
    clustered = Spectrum(*column)
    assert clustered.negative_modes == diverging(clustered) == 2 and clustered.negative is None
    with pytest.raises(Clustered):
        divergence(clustered)


def test_an_instability_that_is_not_determined_is_not_certified(monkeypatch):
    """Contacts slide under an oblique force, and no lowest direction is found: neither stable nor unstable."""
    problem, rest = at_rest(scene(3, 5, contact__friction=0.5, wall__friction=0.5, loads=pushed(0.3, -2.0)))
    (state,) = follow(problem, rest, [1.0])
    assert state.certificate.stable and not any(event.lost for event in state.reached.events)
    system = StaticSystem(problem, state)
    trial = system.at(state)
    found = Spectrum(system, trial)
    monkeypatch.setattr(Spectrum, "negative_modes", 1)
    monkeypatch.setattr(stability, "lowest_real", lambda *_: None)
    assert (np.abs(trial.sense) == SLIDING).any() and diverging(found) is None
