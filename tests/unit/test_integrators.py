"""Integrators where they are exact, and the contact law by hand (Sec. III.A)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_loop import Material, contact_force
from small_scenes import free_disks

from granular_response.contact import Linear
from granular_response.contact.coulomb import CUT, LITERAL, RULES, UNLOADING, tangential
from granular_response.contact.law import normal_force
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics


@pytest.mark.parametrize("name", INTEGRATORS)
def test_free_fall_is_exact(name):
    """Constant acceleration: position and velocity are right to rounding for every integrator."""
    problem, state = free_disks([[500.0, 400.0]], velocity=[(0.3, 2.0)], contact__friction=0.0)
    dynamics = Dynamics(problem, state, name, 2e-3)
    dynamics.advance(1000)
    assert dynamics.rebuilds > 2
    assert dynamics.time == pytest.approx(2.0)
    assert dynamics.position[0] == pytest.approx([500.6, 400.0 + 4.0 - 2.0], abs=1e-10)
    assert dynamics.v == pytest.approx([0.3, 2.0 - 2.0], abs=1e-11)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_free_spin_is_exact(name):
    problem, state = free_disks([[500.0, 400.0]], spin=[2.0], contact__friction=0.3)
    dynamics = Dynamics(problem, state, name, 1e-3)
    dynamics.advance(500)
    assert dynamics.angle == pytest.approx([1.0], abs=1e-12)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_same_bits_in_one_part_or_many(name):
    runs = []
    for parts in ([96], [8] * 12, [40, 56]):
        problem, state = free_disks([[10.0, 1.0], [11.0, 2.7]], contact__friction=0.5)
        dynamics = Dynamics(problem, state, name, 2e-4)
        for steps in parts:
            dynamics.advance(steps)
        runs.append(np.concatenate([dynamics.q, dynamics.v]))
    assert np.array_equal(runs[0], runs[1])
    assert np.array_equal(runs[0], runs[2])


# round numbers: k_N 1000, nu_N 10, k_T 800, nu_T 5, mu 0.5
LAW = Linear(1000.0, 10.0, 800.0, 5.0, 0.5, -math.inf)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_sliding_is_cut_with_the_dashpot_and_the_spring_follows(sign):
    """The limit is 0.5 * 4 = 2; the spring that gives it beside the dashpot's 1 is (2 - 1) / 800."""
    force, spring = tangential(sign * 3e-3, sign * 0.2, 4.0, LAW, CUT, 5e-3)
    assert force == pytest.approx(-sign * 2.0)
    assert spring == pytest.approx(sign * 1.0 / 800.0)
    again, kept = tangential(spring, sign * 0.2, 4.0, LAW, CUT, 0.0)
    assert (again, kept) == (pytest.approx(force), pytest.approx(spring))


def test_unloading_rule_freezes_the_spring_against_further_stretch_alone():
    force, frozen = tangential(1e-2, 0.2, 10.0, LAW, UNLOADING, 5e-3)
    assert (force, frozen) == (pytest.approx(-8.0 - 1.0), 1e-2)
    force, back = tangential(1e-2, -0.2, 10.0, LAW, UNLOADING, 5e-3)
    assert (force, back) == (pytest.approx(-7.2 + 1.0), pytest.approx(9e-3))
    unloading, literal = (tangential(1e-3, 0.2, 10.0, LAW, rule, 5e-3) for rule in (UNLOADING, LITERAL))
    assert unloading == literal


finite = st.floats(-5.0, 5.0, allow_nan=False)


@given(overlap=st.floats(1e-6, 0.1), normal=finite, slip=finite, spring=st.floats(-0.02, 0.02), dt=st.floats(0.0, 1e-2))
def test_agrees_with_the_plain_law(overlap, normal, slip, spring, dt):
    material = Material(1000.0, 10.0, 800.0, 5.0, 0.5)
    fn = normal_force(overlap, None, normal, LAW)
    for name, rule in RULES.items():
        expected = contact_force(material, overlap, normal, slip, spring, dt, name)
        assert (fn, *tangential(spring, slip, fn, LAW, rule, dt)) == pytest.approx(expected, rel=1e-12, abs=1e-13)
