"""What figures share: settings, panels, and pictures of packings, in which things are where the arrays say."""

import io

import matplotlib as mpl
import matplotlib.image
import numpy as np
import pytest

from granular_response.plot import network as nd
from granular_response.plot import style
from granular_response_paper import panels


@style.context()
def _drawn():
    drawn, axes = style.figure(1, 2, height=2.0)
    for index in range(3):
        axes[0, 0].plot([0.0, 1.0], [index, index + 1.0], label=f"$F = {index}\\,mg$")
    axes[0, 0].legend()
    axes[0, 1].set_xlabel("$x/R$")
    style.letter(axes[0, 0], "a")
    return drawn


@pytest.mark.parametrize("file_format", ["png", "pdf", "svg"])
def test_bytes_do_not_depend_on_the_users_settings(file_format: str) -> None:
    plain = style.render(_drawn(), file_format)
    with mpl.rc_context({"font.size": 20, "lines.linewidth": 9, "legend.facecolor": "red", "grid.color": "blue"}):
        assert style.render(_drawn(), file_format) == plain
    with style.context():
        other = _drawn()
        other.axes[0].set_title("changed")
    assert style.render(other, file_format) != plain


def test_the_users_settings_come_back_and_those_of_a_backend_stay() -> None:
    """A backend of notebooks is loaded with the first figure, and switches to interactive: it shows no other."""
    before = mpl.rcParams.copy()
    with mpl.rc_context({"font.size": 20}):
        with pytest.raises(KeyError), style.context():
            mpl.interactive(True)
            assert mpl.rcParams["font.size"] == style.RC["font.size"]
            raise KeyError
        assert mpl.rcParams["font.size"] == 20 and mpl.is_interactive()
    assert mpl.rcParams == before


def test_saved_files_carry_no_date_and_no_program(tmp_path) -> None:
    drawn = _drawn()
    png, pdf = style.save(drawn, "fig00_test", tmp_path / "new", ("png", "pdf"))
    assert (png.name, pdf.name) == ("fig00_test.png", "fig00_test.pdf")
    assert png.read_bytes() == style.render(drawn, "png")
    assert b"Software" not in png.read_bytes()
    assert b"CreationDate" not in pdf.read_bytes()
    assert sorted(path.name for path in png.parent.iterdir()) == [pdf.name, png.name]


def test_lines_of_forces_and_their_key_have_one_scale():
    """Length and width are proportional to the force, as the captions of Figs. 2, 13 and 17 ask."""
    axes = style.figure()[1][0, 0]
    along = np.array([[0.6, 0.8], [1.0, 0.0]])
    contacts = panels.ContactLines(np.array([[1.0, 2.0], [5.0, 2.0]]), along)
    panels.forces(axes, contacts, np.array([[3.0, 4.0], [2.5, 0.0]]), 5.0)
    panels.force_key(axes, (8.0, 6.0), 1.0, 5.0, style.WEIGHT)
    drawn, key = axes.collections
    length = np.linalg.norm(np.diff(np.array([*drawn.get_segments(), *key.get_segments()]), axis=1)[:, 0], axis=1)
    np.testing.assert_allclose(length, panels.LONGEST * np.array([1.0, 0.5, 0.2]))
    width = np.concatenate([drawn.get_linewidth(), key.get_linewidth()])
    np.testing.assert_allclose(width, panels.WIDEST * np.array([1.0, 0.5, 0.2]))
    panels.forces(axes, contacts, np.zeros((2, 2)), 0.0)
    assert len(axes.collections) == 2


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
