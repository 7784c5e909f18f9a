"""The contact law against pairs worked out by hand (Sec. III.A)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_loop import Material, contact_force

from granular_response.contact import Linear
from granular_response.contact.coulomb import (
    RULES,
    tangential,
    tangential_cut,
    tangential_literal,
    tangential_unloading,
)
from granular_response.contact.law import normal_force

# round numbers: k_N 1000, nu_N 10, k_T 800, nu_T 5, mu 0.5
LAW = Linear(1000.0, 10.0, 800.0, 5.0, 0.5, -math.inf)
NO_PULL = LAW._replace(least_force=0.0)


def test_head_on():
    assert normal_force(0.01, None, -0.3, LAW) == pytest.approx(10.0 + 3.0)
    assert normal_force(0.01, None, 0.3, LAW) == pytest.approx(10.0 - 3.0)


def test_dashpot_may_pull_unless_cut_off():
    assert normal_force(0.001, None, 2.0, LAW) == pytest.approx(1.0 - 20.0)
    assert normal_force(0.001, None, 2.0, NO_PULL) == 0.0
    assert normal_force(0.01, None, 0.3, NO_PULL) == normal_force(0.01, None, 0.3, LAW)


def test_sticking():
    """Spring 1e-3 + 0.2 * 5e-3 = 2e-3; force -(1.6 + 1.0) is below the limit 0.5 * 10."""
    force, spring = tangential_cut(1e-3, 0.2, 10.0, LAW, 5e-3)
    assert (force, spring) == (pytest.approx(-2.6), pytest.approx(2e-3))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_sliding_is_cut_with_the_dashpot_and_the_spring_follows(sign):
    """The limit is 0.5 * 4 = 2; the spring that gives it beside the dashpot's 1 is (2 - 1) / 800."""
    force, spring = tangential_cut(sign * 3e-3, sign * 0.2, 4.0, LAW, 5e-3)
    assert force == pytest.approx(-sign * 2.0)
    assert spring == pytest.approx(sign * 1.0 / 800.0)
    again, kept = tangential_cut(spring, sign * 0.2, 4.0, LAW, 0.0)
    assert (again, kept) == (pytest.approx(force), pytest.approx(spring))


def test_coulomb_limit_of_a_pulling_contact_uses_its_magnitude():
    force, _ = tangential_cut(1e-2, 0.0, -4.0, LAW, 0.0)
    assert force == pytest.approx(-2.0)


def test_sliding_contact_sticks_as_soon_as_it_turns_back():
    _, spring = tangential_cut(1e-2, 0.0, 4.0, LAW, 0.0)
    assert spring == pytest.approx(2.0 / 800.0)
    force, back = tangential_cut(spring, -0.1, 4.0, LAW, 1e-3)
    assert back == pytest.approx(spring - 1e-4)
    assert force == pytest.approx(-800.0 * back + 0.5)


def test_literal_rule_freezes_the_spring_beyond_the_limit_also_on_unloading():
    free, moved = tangential_literal(1e-3, 0.2, 10.0, LAW, 5e-3)
    assert (free, moved) == (pytest.approx(-2.6), pytest.approx(2e-3))
    for slip in (0.2, -0.2):
        force, frozen = tangential_literal(1e-2, slip, 10.0, LAW, 5e-3)
        assert frozen == 1e-2
        assert force == pytest.approx(-8.0 - 5.0 * slip)  # beyond the limit of 5: the force is not cut


def test_unloading_rule_freezes_the_spring_against_further_stretch_alone():
    force, frozen = tangential_unloading(1e-2, 0.2, 10.0, LAW, 5e-3)
    assert (force, frozen) == (pytest.approx(-8.0 - 1.0), 1e-2)
    force, back = tangential_unloading(1e-2, -0.2, 10.0, LAW, 5e-3)
    assert (force, back) == (pytest.approx(-7.2 + 1.0), pytest.approx(9e-3))
    within = (1e-3, 0.2, 10.0, LAW, 5e-3)
    assert tangential_unloading(*within) == tangential_literal(*within)


finite = st.floats(-5.0, 5.0, allow_nan=False)


@given(overlap=st.floats(1e-6, 0.1), normal=finite, slip=finite, spring=st.floats(-0.02, 0.02), dt=st.floats(0.0, 1e-2))
def test_agrees_with_the_plain_law(overlap, normal, slip, spring, dt):
    material = Material(1000.0, 10.0, 800.0, 5.0, 0.5)
    fn = normal_force(overlap, None, normal, LAW)
    for name, rule in RULES.items():
        expected = contact_force(material, overlap, normal, slip, spring, dt, name)
        assert (fn, *tangential(spring, slip, fn, LAW, rule, dt)) == pytest.approx(expected, rel=1e-12, abs=1e-13)


@given(slip=finite, spring=st.floats(-0.02, 0.02), fn=st.floats(-20.0, 100.0), dt=st.floats(0.0, 1e-2))
def test_cut_never_exceeds_the_limit_and_is_odd(slip, spring, fn, dt):
    force, new = tangential_cut(spring, slip, fn, LAW, dt)
    assert abs(force) <= 0.5 * abs(fn)
    assert -800.0 * new - 5.0 * slip == pytest.approx(force, abs=1e-9)
    assert tangential_cut(-spring, -slip, fn, LAW, dt) == (-force, -new)
