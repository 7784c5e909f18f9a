"""Packings of the experiments at small size, from parameters through a file."""

import numpy as np
import pytest
import reduced

from granular_response_extensions.experiments import simulate
from granular_response_extensions.experiments.parameters import Parameters


def test_statistics_of_known_profiles():
    """Rays at 60 degrees, and a stress whose width is as the depth."""
    asked = Parameters(**reduced.parameters("experiments") | {"reach": 60, "depths": 20, "ring": [6.0, 12.0]})
    x, depth = np.arange(-60.0, 60.5, 0.5), np.arange(1.0, 21.0)[:, None]
    rays = sum(np.exp(-((x + sign * depth / np.sqrt(3.0)) ** 2)) for sign in (-1.0, 1.0))
    stress = 2.0 / np.pi / depth / (1.0 + (x / depth) ** 2) ** 2
    found = simulate.statistics(asked, x, 25.0, rays, stress)
    assert abs(found["chain"] - 60.0) <= 1.0 and found["contrast"] > 3.0 and found["dip"] == 0.0
    assert found["power"][:, 0] == pytest.approx([1.0, 1.0], abs=0.02)
    width = found["length"][:, 11] / 12.0  # per depth
    assert width == pytest.approx([np.sqrt(np.sqrt(2.0) - 1.0), 0.4417], abs=0.01)
