"""The shared look: it does not depend on the user's settings, and files have the same bytes every time."""

import io

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import font_manager
from matplotlib.colors import to_rgb
from PIL import Image

from granular_response.plot import style


@style.context()
def _drawn():
    drawn, axes = style.figure(1, 2, width="double", height=2.0)
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


def test_a_png_has_the_pixels_of_matplotlib_in_fewer_bytes() -> None:
    lines, (field_figure, panels) = _drawn(), style.figure()
    panels[0, 0].pcolormesh(np.add.outer(np.linspace(0.0, 1.0, 60), np.linspace(0.0, 2.0, 90)), shading="gouraud")
    for drawn in (lines, field_figure):  # the one is smaller without, the other with filtered rows
        plain = io.BytesIO()
        with style.context():
            drawn.savefig(plain, format="png", dpi=200)
        reduced = style.render(drawn)
        assert len(reduced) < len(plain.getvalue())
        with Image.open(plain) as one, Image.open(io.BytesIO(reduced)) as other:
            np.testing.assert_array_equal(np.asarray(one.convert("RGB")), np.asarray(other))
            assert other.info["dpi"] == pytest.approx((200.0, 200.0), rel=1e-3)


def test_fonts_are_those_that_matplotlib_ships() -> None:
    with style.context():
        for properties in ({}, {"style": "italic"}, {"weight": "bold"}):
            font = font_manager.FontProperties(**properties)
            assert font_manager.findfont(font, fallback_to_default=False).startswith(mpl.get_data_path())


@pytest.mark.parametrize("of", style.RAMPS)
def test_ordered_colours_darken_to_one_side_and_are_seen_on_white(of: str) -> None:
    colours = np.array([to_rgb(colour) for colour in style.ordered_colours(9, of=of)])
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    luminance = linear @ np.array([0.2126, 0.7152, 0.0722])  # of WCAG 2
    assert np.all(np.diff(luminance) > 0.0)
    assert 1.05 / (luminance[-1] + 0.05) > 2.9


def test_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="width = 'triple'"):
        style.figure(width="triple")
    with pytest.raises(ValueError, match="count = 0"):
        style.ordered_colours(0)
    with pytest.raises(ValueError, match="file_format = 'bmp'"):
        style.render(_drawn(), "bmp")


def test_a_symbol_with_its_value_is_set_with_unit_and_power() -> None:
    assert style.equals(style.FRICTION, 0.2) == r"$\mu = 0.2$"
    assert style.equals("k_N", 1e5, style.STIFFNESS_UNIT) == r"$k_N = 10^{5}\,\bar m g/\bar R$"
    assert style.equals("k_N", 3000.0) == "$k_N = 3000$"
