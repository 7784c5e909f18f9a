"""The influence of every disk on a slab of 6 layers, from parameters through a file."""

import numpy as np
import pytest

from granular_response_extensions.influence import simulate


def test_equivalent_loads_differ_less_from_row_to_row(datasets):
    lattice = datasets["saint_venant"]["difference"].isel(case=0, realization=0, separation=0).values
    assert (np.diff(lattice[:4]) < 0.0).all()
    assert np.isnan(datasets["saint_venant"]["exponent"].isel(case=0, realization=1)).all()  # a lattice has one


def test_the_power_of_a_power_law_is_found():
    height = np.linspace(1.0, 30.0, 30)
    assert simulate.decay(height, 3.0 * height**-1.7, 2.0, (2.0, 8.0)) == pytest.approx([1.7] * 3)
    assert np.isnan(simulate.decay(height, height**-1.7, 2.0, (2.0, 2.5))).all()
