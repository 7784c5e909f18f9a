"""Moduli of the spring lattice: eqs. (7)-(10), the lattice itself, the two forms of the peak criterion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusals

from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli

stiffness = st.floats(0.05, 5.0)
SETS = [
    Springs(1.0, 1.0),
    Springs(2.0, 1.0, 0.4, 0.0),
    Springs(0.7, 1.3, 0.2, 0.9),
    Springs.uniform(3000.0, 2400.0),
    Springs(0.0, 1.0, 0.0, 0.3),
]


@pytest.mark.parametrize("springs", SETS)
def test_periodic_lattice_has_the_moduli_of_the_paper_and_free_rotations_another_shear_modulus(springs) -> None:
    suppressed, free = (lattice.moduli(springs, rotations).matrix() for rotations in ("suppressed", "free"))
    for rotations, expected in (("suppressed", suppressed), ("free", free)):
        measured = lattice.measured_moduli(springs, rotations)
        np.testing.assert_allclose(measured, expected, rtol=0, atol=1e-13 * expected.max())
    np.testing.assert_array_equal(free[:2, :2], suppressed[:2, :2])
    assert free[2, 2] == pytest.approx(suppressed[2, 2], rel=1e-14) or springs.k1t != springs.k2t
    assert free[2, 2] < suppressed[2, 2] or springs.k1t == springs.k2t


def test_r_without_horizontal_springs_is_the_papers_function() -> None:
    for beta in (0.0, 0.1, 0.5, 2.0):
        expected = (beta**2 + 10.0 * beta - 3.0) / (beta**2 + 6.0 * beta + 9.0)
        assert lattice.peak_criterion(beta) == pytest.approx(expected, abs=1e-14)
        if beta:
            moduli = lattice.moduli(Springs(0.0, 1.0, 0.0, beta))
            assert moduli.peak_criterion == pytest.approx(expected, abs=1e-14)


def test_roots_of_r() -> None:
    assert lattice.peak_criterion_root() == pytest.approx(2.0 * np.sqrt(7.0) - 5.0, abs=1e-14)
    assert round(lattice.peak_criterion_root(), 4) == 0.2915
    assert lattice.peak_criterion_root("free") == pytest.approx(3.0 / 11.0, abs=1e-14)


@given(k_n=stiffness, k_t=st.floats(0.0, 5.0))
def test_equal_bonds_are_isotropic(k_n: float, k_t: float) -> None:
    for rotations in ("suppressed", "free"):
        m = lattice.moduli(Springs.uniform(k_n, k_t), rotations)
        assert (m.b, m.d) == pytest.approx((m.a, m.a - m.c), abs=1e-12 * m.a)
        assert m.poisson_ratio == pytest.approx(lattice.poisson_ratio(k_n, k_t), abs=1e-12)
        assert m.shape == pytest.approx((2.0, 1.0), rel=1e-10)
        assert m.peak_criterion == pytest.approx(1.0, rel=1e-10)


@given(k1n=stiffness, k2n=stiffness, k1t=stiffness, k2t=stiffness)
def test_criterion_r_is_a_ratio_of_the_shape(k1n: float, k2n: float, k1t: float, k2t: float) -> None:
    m = lattice.moduli(Springs(k1n, k2n, k1t, k2t))
    s, p = m.shape
    assert m.peak_criterion == pytest.approx(s / (2.0 * p), rel=1e-9, abs=1e-12)


def test_isotropic_constructor_inverts() -> None:
    m = Moduli.isotropic(0.3, 2.5)
    a11, a12, a22, a66 = m.compliances
    assert (a11, a12, a22, a66) == pytest.approx((1 / 2.5, -0.3 / 2.5, 1 / 2.5, 2.6 / 2.5), rel=1e-14)
    np.testing.assert_allclose(
        m.matrix() @ np.array([[a11, a12, 0], [a12, a22, 0], [0, 0, a66 / 2]]), np.eye(3), atol=1e-14
    )


test_bad_input_is_named = refusals(
    ValueError,
    (lambda: Moduli(1.0, 1.0, 1.0, 1.0), r"modulus c = 1\.0"),
    (lambda: Moduli.isotropic(1.0), r"poisson_ratio = 1\.0"),
    (lambda: Springs(-1.0, 1.0), r"k1n = -1\.0"),
    (lambda: Springs(1.0, 0.0), r"k2n = 0\.0: must be positive"),
    (lambda: lattice.moduli(Springs(0.0, 1.0)), r"modulus c"),
    (lambda: lattice.moduli(Springs(1.0, 1.0), "some"), r"rotations = 'some'"),
)
