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


def strained(springs: Springs, rotations: str) -> np.ndarray:
    """Stress per strain from three bonds: in a lattice with one disk a cell all disks move and turn alike."""
    along = np.array([[1.0, 0.0], [0.5, np.sqrt(0.75)], [-0.5, np.sqrt(0.75)]])
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    k = np.array([springs.k1n, springs.k2n, springs.k2n, springs.k1t, springs.k2t, springs.k2t])
    e, b = np.concatenate([along, across]), 2.0 * np.concatenate([along, along])
    stretch = np.stack([e[:, 0] * b[:, 0], e[:, 1] * b[:, 1], e[:, 0] * b[:, 1] + e[:, 1] * b[:, 0]], axis=1)
    relaxed = stretch
    arm = np.repeat([0.0, 2.0], 3)  # a turn of all disks stretches the springs along the tangent
    if rotations == "free" and k @ arm:  # until no disk feels a torque
        relaxed = stretch - np.outer(arm, (k * arm) @ stretch / (k @ arm**2))
    return (stretch * [1.0, 1.0, 0.5]).T @ (k[:, None] * relaxed) / (2.0 * np.sqrt(3.0))


@pytest.mark.parametrize("rotations", ["suppressed", "free"])
@pytest.mark.parametrize("springs", SETS)
def test_a_lattice_has_the_moduli_of_the_paper(springs: Springs, rotations) -> None:
    expected = lattice.moduli(springs, rotations).matrix()
    np.testing.assert_allclose(strained(springs, rotations), expected, rtol=0, atol=1e-13 * expected.max())
    lower = lattice.moduli(springs, "suppressed").matrix() - expected  # free rotations lower the shear modulus alone
    alike = rotations == "suppressed" or springs.k1t == springs.k2t
    assert abs(lower[2, 2]) < 1e-14 * expected[2, 2] if alike else lower[2, 2] > 0.0
    assert not lower[:2].any() and not lower[2, :2].any()


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
