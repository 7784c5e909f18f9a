"""What the figures of several groups repeat."""

import numpy as np
import pytest

from granular_response.plot import style
from granular_response_paper import panels


def test_wanted_values_are_those_that_are_stored_or_all():
    assert panels.among(np.array([0.0, 0.2, 1.0]), (0.2, 0.5, 1.0)) == [0.2, 1.0]
    assert panels.among(np.array([0.3, 0.4]), (0.2, 0.5)) == [0.3, 0.4]


@pytest.mark.parametrize("marked", [True, False])
def test_curves_of_a_family_differ_in_colour_and_form(marked):
    looks = [look for _, look in panels.family([4.0, 10.0, 20.0], of="force", marked=marked, dashed=not marked)]
    assert len({look["color"] for look in looks}) == 3
    assert len({str(look["marker" if marked else "linestyle"]) for look in looks}) == 3
    assert not list(panels.family([], of="force"))


def test_names_beside_curves_do_not_cover_each_other():
    axes = style.figure()[1][0, 0]
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    panels.label_ends(axes, [("high", 0.5, 0.52, "black"), ("low", 0.5, 0.5, "black"), ("far", 0.5, 0.9, "black")])
    axes.figure.draw_without_rendering()
    low, high, far = (one.get_window_extent() for one in axes.texts)
    assert [text.get_text() for text in axes.texts] == ["low", "high", "far"]
    assert low.y1 <= high.y0 + 2.0 and high.y1 < far.y0


def test_titles_have_the_letters_of_their_picture():
    figure, axes = style.figure(1, 3)
    panels.titles(axes.flat, ("one", "two"), stem="fig05b_stiffness")
    assert style.drawn_letters(figure) == ["e", "f"]


def test_packings_have_names():
    assert panels.material(0.0, 0.2) == "lattice, $\\mu = 0.2$"
    assert panels.packing(0.25) == "$\\delta = 0.25$"
