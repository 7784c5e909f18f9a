"""Pictures of packings: what is drawn is where the arrays say."""

import io

import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_hex

from granular_response.plot import network as nd
from granular_response.plot import style
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL

POSITION = np.array([[1.0, 1.0], [3.0, 1.0], [2.0, 1.0 + np.sqrt(3.0)], [4.2, 2.5]])
RADIUS = np.array([1.0, 1.0, 1.0, 0.5])
FIRST, SECOND = np.array([0, 0, 1, 1]), np.array([1, 2, 2, 3])


@pytest.fixture
def axes():
    return style.figure()[1][0, 0]


def test_a_drawn_disk_covers_its_area() -> None:
    figure, panels = style.figure(width=2.0, height=2.0)
    axes = panels[0, 0]
    nd.draw_disks(axes, [[0.0, 0.0]], 1.5, facecolor="black", edgecolor="none")
    axes.set(xlim=(-2.0, 2.0), ylim=(-2.0, 2.0))
    style.no_axes(axes)
    picture = matplotlib.image.imread(io.BytesIO(style.render(figure)))[..., 0]
    per_unit = axes.bbox.width * 200.0 / figure.dpi / 4.0
    assert np.sum(1.0 - picture) == pytest.approx(np.pi * 1.5**2 * per_unit**2, rel=5e-3)


def test_contact_points_lie_between_the_surfaces() -> None:
    point = nd.pair_points(POSITION, RADIUS, FIRST, SECOND)
    np.testing.assert_allclose(point[0], [2.0, 1.0])
    for disk in (FIRST, SECOND):
        distance = np.linalg.norm(point - POSITION[disk], axis=1) - RADIUS[disk]
        other = np.linalg.norm(POSITION[FIRST] - POSITION[SECOND], axis=1) - RADIUS[FIRST] - RADIUS[SECOND]
        np.testing.assert_allclose(distance, 0.5 * other, atol=1e-12)
    walls = nd.wall_points(POSITION, RADIUS, [0, 0, 3], [FLOOR, LEFT_WALL, RIGHT_WALL])
    np.testing.assert_allclose(walls, [[1.0, 0.0], [0.0, 1.0], [4.7, 2.5]], atol=1e-15)


def test_forces_that_press_together_and_apart_are_told_apart(axes) -> None:
    """Each has the colour of its kind, whatever its direction is."""
    point, normal = np.zeros((4, 2)), np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    force = np.array([[2.0, 1.0], [0.0, -1.0], [-1.0, 3.0], [0.0, 2.0]])
    drawn = nd.draw_signed_forces(axes, point, force, normal, length_per_force=1.0, width_per_force=1.0)
    vectors = {name: np.diff(np.array(one.get_segments()), axis=1)[:, 0] for name, one in drawn.items()}
    np.testing.assert_allclose(vectors["force increased"], force[[0, 2]])
    np.testing.assert_allclose(vectors["force decreased"], force[[1, 3]])
    colours = {name: to_hex(one.get_colors()[0]).upper() for name, one in drawn.items()}
    assert colours == {"force increased": style.INCREASED, "force decreased": style.DECREASED}
    only = nd.draw_signed_forces(axes, point[:1], force[:1], normal[:1], length_per_force=1.0, width_per_force=1.0)
    assert list(only) == ["force increased"]


def test_rotation_marks_start_vertical_and_turn_counter_clockwise(axes) -> None:
    marks = np.array(nd.draw_rotations(axes, POSITION[:2], RADIUS[:2], [0.0, np.pi / 2]).get_segments())
    direction = marks[:, 1] - marks[:, 0]
    np.testing.assert_allclose(direction / np.linalg.norm(direction, axis=1)[:, None], [[0, 1], [-1, 0]], atol=1e-15)
    np.testing.assert_allclose(marks.mean(axis=1), POSITION[:2])


def test_bad_input_is_named(axes) -> None:
    with pytest.raises(ValueError, match=r"position: must have shape \(n, 2\)"):
        nd.draw_disks(axes, [1.0, 2.0], 1.0)
    with pytest.raises(ValueError, match="force: 1 given for 2"):
        nd.draw_force_chains(axes, POSITION[:2], POSITION[:1], length_per_force=1.0, width_per_force=1.0)
