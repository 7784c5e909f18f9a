"""Widths of the closed forms of the three descriptions, and the powers with which they grow."""

import numpy as np
import pytest
from scipy.optimize import brentq

from granular_response.theory import half_plane, rays
from granular_response.theory.moduli import Moduli
from granular_response_extensions.experiments.simulate.widths import FITS, lengths, powers

T = np.linspace(0.0, 3.0, 3001)
DEPTHS = np.geomspace(20.0, 200.0, 8)


def grown(pressure):
    """Widths (depth, definition) in radii of a pressure of x and depth, and their powers."""
    found = lengths(T, np.stack([pressure(T * z, z) * z for z in DEPTHS])) * DEPTHS[:, None]
    return found, powers(DEPTHS, found.T)


def test_an_elastic_half_plane_is_as_wide_as_it_is_deep():
    solid = Moduli.isotropic(0.3)
    found, power = grown(lambda x, z: half_plane.pressure(x, z, solid))
    half_force = brentq(lambda t: (np.arctan(t) + t / (1.0 + t * t)) / np.pi - 0.25, 0.0, 1.0)
    half_maximum = np.sqrt(np.sqrt(2.0) - 1.0)  # of Flamant's solution, (1 + t^2)^-2
    assert found[:, 0] == pytest.approx(DEPTHS * half_maximum, rel=1e-5)
    assert found[:, 1] == pytest.approx(DEPTHS * half_force, rel=1e-5)
    assert power == pytest.approx(np.ones((2, len(FITS))), abs=1e-9)


def test_force_that_diffuses_is_as_wide_as_the_root_of_the_depth():
    found, power = grown(lambda x, z: rays.pressure(x, z, angle=0.0, diffusion_length=0.5))
    assert found[:, 0] == pytest.approx(np.sqrt(2.0 * np.log(2.0) * 0.5 * DEPTHS), rel=1e-4)
    assert power == pytest.approx(np.full((2, len(FITS)), 0.5), abs=1e-3)


def test_fits_leave_out_the_ends():
    depth = np.geomspace(1.0, 9.0, 9)
    bent = np.where(depth > 6.0, 2.0, 1.0) * depth
    everything, deep, shallow = powers(depth, bent)
    assert shallow == pytest.approx(1.0) and 1.0 < everything < deep
