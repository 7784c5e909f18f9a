"""What a reader has read off other pictures: drawn in grey in the right panel, or refused with file, key and value."""

import doctest
import json
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from places import ROOT
from refusals import refuses

from granular_response.plot import style
from granular_response_paper import captions, digitised
from granular_response_paper.pipeline import drawing
from granular_response_paper.registry import GroupError, collections

GOOD = {"source": "Somebody 1999, Fig. 3", "error_x": "0.05", "error_y": "0.1"}
NAMES = {"plain": "fig17_pile_profiles", "lettered": "fig17_pile"}


@style.context()
def pictures():
    """Two pictures of the group pile_dip, two panels each: without letters and with a colour bar, and with letters."""
    drawn = {}
    for name, stem in NAMES.items():
        drawn[stem], axes = style.figure(1, 2)
        for index, panel in enumerate(axes.flat):
            panel.plot([0.0, 1.0], [0.0, 1.0], label="here")
            if name == "lettered":
                style.letter(panel, "ab"[index])
    first, second = drawn[NAMES["plain"]].axes
    first.legend()
    drawn[NAMES["plain"]].colorbar(second.scatter([0.0], [0.0], c=[0.0]), ax=second)
    return drawn


def written(folder: Path, name: str, points="0.2,0.3\n0.4,0.5\n", header="x,y", **said) -> Path:
    keys = "".join(f"# {key}: {value}\n" for key, value in (GOOD | said).items() if value is not None)
    (folder / name).write_text(f"{keys}{header}\n{points}")
    return folder / name


def added(folder: Path):
    figures = pictures()
    return figures, digitised.add(figures, "pile_dip", folder)


def test_a_file_is_drawn_in_grey_with_bars_below_the_curves(tmp_path):
    written(tmp_path, "fig17_pile_profiles.csv", label="$5 of it")
    figures, said = added(tmp_path)
    first, second, _ = figures[NAMES["plain"]].axes
    assert not second.containers and not any(axes.containers for axes in figures[NAMES["lettered"]].axes)
    (bars,) = first.containers
    points, _, (along, across) = bars
    np.testing.assert_array_equal(points.get_xydata(), [[0.2, 0.3], [0.4, 0.5]])
    np.testing.assert_allclose(along.get_segments()[0], [[0.15, 0.3], [0.25, 0.3]])
    np.testing.assert_allclose(across.get_segments()[1], [[0.4, 0.4], [0.4, 0.6]])
    assert {to_hex(one.get_color()) for one in (points,)} == {style.DIGITISED.lower()}
    assert {to_hex(one.get_color()[0]) for one in (along, across)} == {style.DIGITISED.lower()}
    assert all(one.get_zorder() < first.lines[0].get_zorder() for one in (points, along, across))
    assert [text.get_text() for text in first.get_legend().get_texts()] == ["here", "$5 of it"]
    assert said == {NAMES["plain"]: f"{digitised.CAPTION}: Somebody 1999, Fig. 3."}
    assert style.render(figures[NAMES["plain"]]) != style.render(pictures()[NAMES["plain"]])


def test_several_files_of_a_picture_find_their_panels(tmp_path):
    written(tmp_path, "fig17_pile.csv", panel="b")
    written(tmp_path, "fig17_pile.another.csv", panel="b", source="Another 2001")
    written(tmp_path, "fig17_pile_profiles.csv", panel="2")
    written(tmp_path, "fig13_force_chains.csv")  # of another group
    (tmp_path / "README.md").write_text("As the paper's.")
    figures, said = added(tmp_path)
    assert [len(axes.containers) for axes in figures[NAMES["lettered"]].axes] == [0, 2]
    assert [len(axes.containers) for axes in figures[NAMES["plain"]].axes] == [0, 1, 0]
    legend = figures[NAMES["lettered"]].axes[1].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["Another 2001", GOOD["source"]]
    assert said[NAMES["lettered"]].endswith(": (b) Another 2001; (b) Somebody 1999, Fig. 3.")


def test_nothing_is_drawn_without_a_file(tmp_path):
    for folder in (tmp_path / "absent", *(ROOT / one.folder / digitised.FOLDER for one in collections())):
        figures = pictures()
        assert digitised.add(figures, "pile_dip", folder) == {}
        assert not any(axes.containers for figure in figures.values() for axes in figure.axes)


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"source": None}, "source: missing, must be given as a line '# source: ...'"),
        ({"source": ""}, "line 1: source = '': must be one of source, error_x, error_y, panel, label, with a value"),
        ({"colour": "red"}, "line 4: colour = 'red': must be one of source, error_x, error_y, panel, label"),
        ({"error_x": "small"}, "error_x = 'small': must be a finite number"),
        ({"error_y": "-0.1"}, "error_y = -0.1: must be 0 or greater"),
        ({"panel": "3"}, "panel = '3': must be one of 1, 2"),
        ({"header": "x,z"}, "header = 'x,z': must be x,y, with a line for each point below it"),
        ({"points": "1,2\n3,a\n"}, "line 6: y = 'a': must be a finite number"),
        ({"points": "1,2,3\n"}, "line 5: has 3 values, must have x y"),
        ({"points": "0.2,0.3\n# source: B\nx,y\n"}, "line 6: source = 'B': is given twice, a second curve needs a"),
    ],
)
def test_a_file_that_cannot_be_drawn_is_refused(tmp_path, change, rule):
    path = written(tmp_path, "fig17_pile_profiles.csv", **change)
    refuses(GroupError, f"^{re.escape(f'{path}: {rule}')}", added, tmp_path)


def test_points_out_of_view_are_refused(tmp_path):
    path = written(tmp_path, "fig17_pile.csv", points="200,0.3\n")
    figure = pictures()[NAMES["lettered"]]
    figure.axes[0].set(xlim=(0.0, 1.0), ylim=(-1.0, 2.0))
    rule = "points = [[200.0, 0.3]]: one must be in view, x from 0 to 1 and y from -1 to 2"
    with pytest.raises(GroupError, match=f"^{re.escape(f'{path}: {rule}')}$"):
        digitised.add({NAMES["lettered"]: figure}, "pile_dip", tmp_path)


@pytest.mark.parametrize("name", ["fig17_pyle.csv", "fig17_pile.txt", "fig17_pile", "fig17_pile.png", "hysteresis.csv"])
def test_a_name_of_no_picture_is_refused(tmp_path, name):
    path = written(tmp_path, name)
    with pytest.raises(GroupError, match=rf"^{re.escape(str(path))}: name = '{name}': must be PICTURE\.csv") as caught:
        added(tmp_path)
    assert ("did you mean fig17_pile.csv?" in str(caught.value)) == name.startswith("fig17")


def test_a_file_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "fig17_pile.csv").write_bytes(b"# source: \xff")
    refuses(GroupError, r"fig17_pile\.csv: is not a text file in UTF-8$", added, tmp_path)


def test_nothing_is_written_if_a_file_is_refused(tmp_path, monkeypatch):
    """The whole stage, for a group that is made up."""
    made = {
        "draw": lambda datasets: pictures(),
        "captions": lambda datasets, parameters: {
            stem: captions.Caption("A caption.", "A picture.", {"force": 1.0}) for stem in NAMES.values()
        },
    }
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(drawing, "group_member", lambda group, module, name, optional=False: made.get(name))
    monkeypatch.setattr(drawing, "_stored", lambda group, path: ({}, None))
    drawing.draw("pile_dip")
    files = {path: path.read_bytes() for path in Path("figures/pile_dip").iterdir()}
    digitised.FOLDER.mkdir()
    path = written(digitised.FOLDER, "fig17_pile_profiles.csv")
    drawing.draw("pile_dip")
    changed = {path: path.read_bytes() for path in files}
    assert {path.name for path in files if changed[path] != files[path]} == {"captions.json", path.stem + ".png"}
    caption = json.loads(changed[Path("figures/pile_dip/captions.json")])[path.stem]["caption"]
    assert caption == f"A caption. {digitised.CAPTION}: {GOOD['source']}. F_ext = 1 {captions.WEIGHT}."
    written(digitised.FOLDER, "fig17_pile_profiles.csv", points="1,five\n")
    with pytest.raises(GroupError, match=r"^figures/digitised/fig17_pile_profiles\.csv: line 5: y = 'five': must be"):
        drawing.draw("pile_dip")
    assert {path: path.read_bytes() for path in files} == changed
    path.unlink()
    drawing.draw("pile_dip")
    assert {path: path.read_bytes() for path in files} == files


def test_examples_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(digitised).failed == 0
    block = re.search(r"```\n(# source.*?)```", (ROOT / digitised.FOLDER / digitised.README).read_text(), re.S)
    Path("fig07.csv").write_text(block[1])
    assert digitised.read(Path("fig07.csv")).panel == "b"
