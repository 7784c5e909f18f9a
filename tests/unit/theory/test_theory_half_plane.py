"""The half plane and the rays: totals, limits, and the balance of forces."""

import numpy as np
import pytest
from scipy.integrate import quad

from granular_response.theory import half_plane, lattice, rays
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli

SOLIDS = [
    Moduli.isotropic(0.3),
    lattice.moduli(Springs(2.0, 1.0)),
    lattice.moduli(Springs(0.1, 1.0)),
    lattice.moduli(Springs(0.0, 1.0, 0.0, 0.1)),
]


@pytest.mark.parametrize("moduli", SOLIDS)
@pytest.mark.parametrize("depth", [0.5, 7.0])
def test_pressure_integrates_to_the_force(moduli: Moduli, depth: float) -> None:
    right, _ = quad(lambda x: float(half_plane.pressure(x, depth, moduli, 15.0)), 0.0, np.inf, limit=400)
    assert 2.0 * right == pytest.approx(15.0, rel=1e-7)


def test_isotropic_limit_is_flamant() -> None:
    x, depth = np.linspace(-5.0, 5.0, 21), 2.0
    flamant = 2.0 * depth**3 / (np.pi * (x**2 + depth**2) ** 2)
    np.testing.assert_allclose(half_plane.pressure(x, depth, Moduli.isotropic(-0.2)), flamant, rtol=1e-12)


@pytest.mark.parametrize("moduli", SOLIDS)
def test_peaks_are_where_the_pressure_is_largest(moduli: Moduli) -> None:
    x = np.linspace(0.0, 2.0, 200_001)
    largest = x[np.argmax(half_plane.pressure(x, 1.0, moduli))]
    assert np.sqrt(max(0.0, -moduli.peak_criterion)) == pytest.approx(largest, abs=2e-5)


def test_rays_carry_the_force_and_widen_like_a_random_walk() -> None:
    x = np.linspace(-300.0, 300.0, 60_001)
    for depth in (40.0, 160.0):
        pressure = rays.pressure(x, depth, angle=np.pi / 6, diffusion_length=0.1, force=3.0)
        right = np.where(x > 0.0, pressure, 0.0)
        assert pressure.sum() * 0.01 == pytest.approx(3.0, rel=1e-10)
        np.testing.assert_allclose(pressure, pressure[::-1], rtol=1e-9, atol=1e-300)
        mean = (x * right).sum() / right.sum()
        variance = ((x - mean) ** 2 * right).sum() / right.sum()
        assert mean == pytest.approx(depth / np.sqrt(3.0), rel=1e-9)
        assert variance == pytest.approx(0.1 * depth, rel=1e-9)
