"""Marks of single figures, on planted data: where they stand, and that none is lost at an edge."""

import numpy as np
import pytest

from granular_response.plot import style
from granular_response_paper.groups.phase_diagram import draw as phase_diagram
from granular_response_paper.groups.stability import draw as stability


@pytest.fixture
def axes():
    return style.figure()[1][0, 0]


def test_brackets_of_the_largest_step_that_settles(axes) -> None:
    """Steps beyond the first that does not settle do not count, and the smallest that blows up has a cross."""
    ratio = np.array([0.5, 1.0, 2.0, 4.0])
    outcome = np.array([[0, 0, 1, 2], [0, 1, 0, 1], [1, 1, 1, 1], [0, 0, 0, 0]])
    stability._limits(axes, ratio, outcome, 0.25, style.marked_line(0), "name")
    (bars,) = axes.collections
    ends = np.array(bars.get_segments())
    np.testing.assert_allclose(ends[:, 0, 0], [0.25, 1.25])  # all or none settle: no bracket
    np.testing.assert_allclose(ends[:, :, 1], [[1.0, 2.0], [0.5, 1.0]])
    crosses = [line.get_xydata().tolist() for line in axes.lines if line.get_marker() == "x"]
    assert crosses == [[[0.25, 4.0]]]


@pytest.mark.parametrize(
    ("low", "high", "heads"),
    [(1.0, 3.0, []), (-np.inf, 3.0, [0.1]), (1.0, np.inf, [10.0]), (-np.inf, np.inf, [0.1, 10])],
)
def test_an_interval_beyond_all_forces_has_an_arrow_head_at_the_edge(axes, low, high, heads) -> None:
    phase_diagram._bar(axes, 0.2, low, high, (0.1, 10.0), 1.0, style.BLUE)
    bar, *arrows = axes.lines
    np.testing.assert_allclose(bar.get_ydata(), np.clip([low, high], 0.1, 10.0))
    assert [float(arrow.get_ydata()[0]) for arrow in arrows] == heads
