"""Marks of single figures, on planted data: where they stand, and that none is lost at an edge."""

import numpy as np
import pytest

from granular_response.plot import style
from granular_response_paper.groups.phase_diagram import draw as phase_diagram


@pytest.fixture
def axes():
    return style.figure()[1][0, 0]


@pytest.mark.parametrize(
    ("low", "high", "heads"),
    [(1.0, 3.0, ""), (-np.inf, 3.0, "v"), (1.0, np.inf, "^"), (-np.inf, np.inf, "v^")],
)
def test_an_interval_beyond_all_forces_has_an_arrow_head_at_the_edge(axes, low, high, heads) -> None:
    phase_diagram._bar(axes, 0.2, low, high, (0.1, 10.0), 1.0, style.BLUE)
    bar, *arrows = axes.lines
    np.testing.assert_allclose(bar.get_ydata(), np.clip([low, high], 0.1, 10.0))
    look = {"v": (phase_diagram.DOWNWARDS, 0.11), "^": (phase_diagram.UPWARDS, 10.0 / 1.1)}
    assert [arrow.get_marker() for arrow in arrows] == [look[head][0] for head in heads]
    assert [float(arrow.get_ydata()[0]) for arrow in arrows] == pytest.approx([look[head][1] for head in heads])
