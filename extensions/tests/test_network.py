"""Contact networks of small slabs, from parameters through a file."""

import numpy as np

from granular_response_extensions.network import simulate


def test_forces_are_relative_to_the_mean_of_their_height():
    rng = np.random.default_rng(0)
    height = rng.uniform(0.0, 12.0, 500)
    forces = 1.0 + np.floor((height - height.min()) / 3.0) + rng.uniform(0.0, 1e-3, 500)
    relative = simulate.relative(forces, height, 3.0)
    np.testing.assert_allclose(relative, 1.0, atol=1e-3)
