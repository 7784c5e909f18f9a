"""The comparison of contact laws on a slab of 5 layers, from parameters through a file to a figure."""

import numpy as np
import pytest

from granular_response_paper.groups.contact_law import draw


def test_both_laws_are_at_rest_and_matched(datasets):
    data = datasets["responses"]
    assert float(data["force_residual"].max()) < 1e-9
    force, (linear, power) = data["typical_force"].values, data["normal_stiffness"].values.T
    overlap = force / linear
    assert (power / 1.5) ** 1.5 * overlap**1.5 == pytest.approx(force, rel=1e-12)
    assert (data["floor_response"].sum("floor_disk") > 0.9).all()
    between = np.abs(data["floor_response"][:, 1] - data["floor_response"][:, 0]).max("floor_disk")
    assert (between > 1e-3).all()  # the laws are not the same one


def test_the_figure_has_a_panel_for_each_friction(datasets, looks_as_stored):
    drawn = draw.draw(datasets)
    looks_as_stored(drawn)
    (figure,) = drawn.values()
    assert len(figure.axes) == 2
    curves = [[line for line in axes.lines if len(line.get_xdata())] for axes in figure.axes]  # others are of legends
    assert {len(lines) for lines in curves} == {4}
