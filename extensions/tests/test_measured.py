"""What the groups experiments, influence and network measure, and widths of the three descriptions in closed form."""

import numpy as np
import pytest
import reduced
from scipy.optimize import brentq

from granular_response.theory import half_plane, rays
from granular_response.theory.moduli import Moduli
from granular_response_extensions.experiments import simulate as experiments
from granular_response_extensions.experiments.parameters import Parameters
from granular_response_extensions.experiments.simulate.widths import FITS, lengths, powers
from granular_response_extensions.influence import simulate as influence
from granular_response_extensions.network import simulate as network

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


def test_statistics_of_known_profiles():
    """Rays at 60 degrees, and a stress whose width is as the depth."""
    asked = Parameters(**reduced.parameters("experiments") | {"reach": 60, "depths": 20, "ring": [6.0, 12.0]})
    x, depth = np.arange(-60.0, 60.5, 0.5), np.arange(1.0, 21.0)[:, None]
    rays = sum(np.exp(-((x + sign * depth / np.sqrt(3.0)) ** 2)) for sign in (-1.0, 1.0))
    stress = 2.0 / np.pi / depth / (1.0 + (x / depth) ** 2) ** 2
    found = experiments.statistics(asked, x, 25.0, rays, stress)
    assert abs(found["chain"] - 60.0) <= 1.0 and found["contrast"] > 3.0 and found["dip"] == 0.0
    assert found["power"][:, 0] == pytest.approx([1.0, 1.0], abs=0.02)
    width = found["length"][:, 11] / 12.0  # per depth
    assert width == pytest.approx([np.sqrt(np.sqrt(2.0) - 1.0), 0.4417], abs=0.01)


def test_equivalent_loads_differ_less_from_row_to_row(tmp_path_factory):
    data = reduced.datasets("influence", tmp_path_factory)["saint_venant"]
    lattice = data["difference"].isel(case=0, realization=0, separation=0).values
    assert (np.diff(lattice[:4]) < 0.0).all()
    assert np.isnan(data["exponent"].isel(case=0, realization=1)).all()  # a lattice has one


def test_the_power_of_a_power_law_is_found():
    height = np.linspace(1.0, 30.0, 30)
    assert influence.decay(height, 3.0 * height**-1.7, 2.0, (2.0, 8.0)) == pytest.approx([1.7] * 3)
    assert np.isnan(influence.decay(height, height**-1.7, 2.0, (2.0, 2.5))).all()


def test_forces_are_relative_to_the_mean_of_their_height():
    rng = np.random.default_rng(0)
    height = rng.uniform(0.0, 12.0, 500)
    forces = 1.0 + np.floor((height - height.min()) / 3.0) + rng.uniform(0.0, 1e-3, 500)
    relative = network.relative(forces, height, 3.0)
    np.testing.assert_allclose(relative, 1.0, atol=1e-3)
