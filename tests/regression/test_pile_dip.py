"""Fig. 17, from parameters through a file to figures. The pile of the paper is small enough for a test."""

import numpy as np


def test_the_frictionless_pile_has_two_minima(datasets) -> None:
    """Floor forces of a minimum known from an independent code: 8.34 in the middle, 9.15 and 9.08 beside it."""
    piles = datasets["piles"]
    floor = piles["floor_force"].values
    middle = floor.shape[1] // 2
    found = [floor[0, middle], floor[0, :middle].max(), floor[0, middle + 1 :].max()]
    np.testing.assert_allclose(found, [8.34, 9.15, 9.08], atol=0.005)
    for one, other, near in ((0, 1, 1e-8), (2, 2, 1e-9)):  # the minima are mirror images, with friction it is its own
        np.testing.assert_allclose(floor[one], floor[other][::-1], atol=near)
