"""Pictures of own results, through the public namespace: what is drawn is what the states say."""

import base64
import io
import os
import subprocess
import sys

import matplotlib
import matplotlib.image
import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import to_hex, to_rgba
from refusals import refuses

import granular_response as gr
from granular_response.plot import network, pictures, style
from granular_response.state import Box

LOADS = [{"disk": {"row": "top"}, "force": [0.5, -4.0], "torque": 0.2}, {"disk": 40, "force": [0.0, -1.0]}]
SCENE = {"packing": {"kind": "slab", "layers": 5, "disks_per_row": 15}, "loads": LOADS}


@pytest.fixture(scope="module")
def result() -> gr.Result:
    return gr.solve(SCENE, load_factors=[0.5, 1.0])


@pytest.fixture
def ax():
    return style.figure()[1][0, 0]


def lines(axes, colour) -> LineCollection:
    """The collection of lines of one colour."""
    found = [c for c in axes.collections if isinstance(c, LineCollection)]
    (one,) = [c for c in found if np.allclose(c.get_colors()[0], to_rgba(colour)) and len(c.get_segments()) > 3]
    return one


def test_response_has_a_curve_for_each_load(result, ax):
    assert gr.plot.response(result, ax=ax) is ax
    curves = [line for line in ax.get_lines() if len(line.get_xdata()) == 15]
    np.testing.assert_array_equal([curve.get_ydata() for curve in curves], result.floor_response.values)
    np.testing.assert_array_equal(curves[0].get_xdata(), result.floor_response["x"].values)
    total = np.hypot(0.5, 4.0) + 1.0
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [f"{total / 2:g}", f"{total:g}"]


def test_forces_are_those_that_the_load_adds(result, ax):
    gr.plot.forces(result, ax=ax, scale="linear")
    data = result.to_dataset()
    rest, loaded = (pictures.Shown.of(data, k) for k in (0, 2))
    added = np.concatenate([loaded.values(f) - rest.values(f) for f in ("contact_force", "wall_force")])
    size = np.linalg.norm(added, axis=1)
    dark, pale = lines(ax, style.INCREASED), lines(ax, style.DECREASED)
    drawn = np.concatenate([np.array(c.get_segments()) for c in (dark, pale)])
    length = np.linalg.norm(drawn[:, 1] - drawn[:, 0], axis=1)
    np.testing.assert_allclose(np.sort(length), np.sort(4.0 * size[size > 0.02 * size.max()] / size.max()), rtol=1e-9)
    width = np.concatenate([c.get_linewidth() for c in (dark, pale)])
    # still seen in print
    np.testing.assert_allclose(width, np.maximum(width.max() * length / length.max(), network.THINNEST))
    ends = np.sum(np.linalg.norm(added[size > 0.02 * size.max()], axis=1))
    assert ends > 0 and len(dark.get_segments()) > len(pale.get_segments())


def test_contacts_are_those_that_changed(result, ax):
    gr.plot.contacts(result, ax=ax)
    status = result.contacts["contact_status"].values
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    counts = {
        c.get_label(): len(c.get_segments())
        for c in ax.collections
        if isinstance(c, LineCollection) and c.get_label() in network.CONTACT_LINES
    }
    expected = {
        "opened": int(((status[0] > 0) & (status[2] == 0)).sum()),
        "closed": int(((status[0] == 0) & (status[2] > 0)).sum()),
        "sliding": int(((status[0] > 0) & (status[2] == 2)).sum()),
        "unchanged": int(((status[0] > 0) & (status[2] == 1)).sum()),
    }
    assert counts == {kind: count for kind, count in expected.items() if count}
    assert counts["opened"] > 0 and labels[0] == "opened"


def test_stress_is_that_of_the_result(result, ax):
    gr.plot.stress(result, ax=ax, component="xx")
    mesh = ax.collections[0]
    x = np.linspace(0.0, 30.0, 61) - result.origin
    shown = pictures.Shown.of(result)
    z = np.linspace(0.0, shown.top, round(2.0 * shown.top) + 1)
    expected = result.stress(x, z).sel(force="x", branch="x").values
    np.testing.assert_allclose(mesh.get_array().reshape(expected.shape), expected, rtol=1e-9, atol=1e-12)
    assert mesh.norm.vmin == -mesh.norm.vmax == pytest.approx(-np.abs(expected).max())


def test_a_packing_has_its_disks_and_values(result, ax):
    gr.plot.packing(result, ax=ax, state=1, values=result.loaded[0].angle)
    disks = ax.collections[0]
    assert isinstance(disks, EllipseCollection)
    np.testing.assert_array_equal(disks.get_offsets(), result.loaded[0].position)
    np.testing.assert_array_equal(disks.get_array(), result.loaded[0].angle)
    refuses(pictures.PictureError, r"values: must have shape \(73,\)", gr.plot.packing, result, ax=ax, values=[1.0])
    with pytest.raises(pictures.PictureError, match=r"^values = \{1\.0\}: must be numbers, a disk each$"):
        gr.plot.packing(result, ax=ax, values={1.0})


@pytest.mark.parametrize("name", ["forces", "contacts", "stress", "packing"])
def test_every_picture_of_a_packing_shows_floor_walls_and_loads(result, name):
    ax = getattr(gr.plot, name)(result, ax=style.figure()[1][0, 0])
    arrows = [text for text in ax.texts if text.arrow_patch is not None]
    assert len(arrows) == 2 and len(ax.patches) == 1  # two forces, one torque
    shift = -result.origin if name == "stress" else 0.0
    ends = [c.get_segments() for c in ax.collections if isinstance(c, LineCollection) and len(c.get_segments()) == 3]
    assert any(np.allclose(np.array(box)[0], [[shift, 0.0], [30.0 + shift, 0.0]]) for box in ends)
    at_rest = getattr(gr.plot, name)(result, ax=style.figure()[1][0, 0], state=0)
    assert not [text for text in at_rest.texts if text.arrow_patch is not None]


def test_stored_and_solved_results_look_the_same(result, tmp_path):
    result.save(tmp_path / "result.nc")
    back = gr.open_result(tmp_path / "result.nc")
    pages = [style.render(gr.plot.page(one, ["response", "forces", "contacts"])) for one in (result, back)]
    assert pages[0] == pages[1]
    picture = matplotlib.image.imread(io.BytesIO(pages[0]))
    assert picture.shape[1] == 1400 and (picture[..., :3] < 0.5).any(axis=2).mean() > 0.01


def test_a_page_has_what_was_asked_for(result):
    assert [title[:5] for title in titles(gr.plot.page(result))] == ["(a) n", "(b) i", "(c) c", "(d) s"]
    with pytest.raises(pictures.PictureError, match="what = 'chains': must be among response, floor, forces"):
        gr.plot.page(result, ["chains"])


@pytest.fixture(scope="module")
def loadless() -> gr.Result:
    return gr.solve({**SCENE, "loads": []})


@pytest.fixture(scope="module")
def turned() -> gr.Result:
    load = {"disk": {"row": "top"}, "force": [0.0, 0.0], "torque": 0.01}
    return gr.solve({**SCENE, "loads": [load]}, load_factors=[0.5, 1.0])


def curve(axes) -> np.ndarray:
    (one,) = [line for line in axes.get_lines() if len(line.get_xdata()) == 15]
    return one.get_ydata()


def titles(figure) -> list[str]:
    return [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]


def test_a_page_without_a_response_has_the_forces_on_the_floor(loadless, turned):
    for state in (-1, 0):
        page = gr.plot.page(loadless, state=state)
        assert titles(page) == [f"({a}, at rest" for a in ("a) floor forces", "b) forces", "c) contacts", "d) stress")]
        at_rest = curve(page.axes[0])
        np.testing.assert_array_equal(at_rest, loadless.to_dataset()["floor_force_rest"])
        assert at_rest.sum() == pytest.approx(73.0, rel=1e-9)  # the weight of all disks
    page, data = gr.plot.page(turned), turned.to_dataset()
    assert titles(page)[0] == rf"(a) floor forces, torque $0.01\,{style.TORQUE_UNIT}$"
    np.testing.assert_array_equal(curve(page.axes[0]), data["floor_force"].values[1] - data["floor_force_rest"].values)
    assert np.abs(curve(page.axes[0])).max() > 1e-6
    assert page.axes[3].get_ylim()[1] > pictures.Shown.of(turned).top + 1.0  # room for the arc
    assert titles(gr.plot.page(turned, state=0))[0] == "(a) floor forces, at rest"


def test_why_there_is_no_response_is_said(loadless, turned, ax):
    nothing = gr.solve(SCENE, load_factors=[0.0])
    for one, why in ((loadless, "no loads"), (turned, "no load has a force"), (nothing, "the loads apply no force in")):
        with pytest.raises(pictures.PictureError, match=f"^result: {why}[^\n]*, so there is no response; floor draws"):
            gr.plot.response(one, ax=ax)
        refuses(pictures.PictureError, "so there is no response", gr.plot.page, one, ["response", "forces"])


def test_bad_input_is_named(result, ax):
    for message, call in {
        "scale = 'log': must be one of linear, sqrt, percentile": lambda: gr.plot.forces(result, ax=ax, scale="log"),
        "component = 'yy'": lambda: gr.plot.stress(result, ax=ax, component="yy"),
        "vmax = 0": lambda: gr.plot.forces(result, ax=ax, vmax=0),
        "holds no states": lambda: gr.plot.forces(result.to_dataset()[["radius"]], ax=ax),
        "color = 'no colour': must be a colour, or 2, one for each load": lambda: gr.plot.response(
            result, ax=ax, color="no colour"
        ),
        "must be a colour, or 2, one for": lambda: gr.plot.response(result, ax=ax, color=["red", "blue", "green"]),
        "must be colours by kind, which are unchanged, sliding": lambda: gr.plot.contacts(result, ax=ax, color="red"),
    }.items():
        refuses(pictures.PictureError, message, call)
    # as of the tables of a result
    refuses(IndexError, "state = 3: must be from -3 to 2", gr.plot.forces, result, ax=ax, state=3)
    refuses(TypeError, "state = 1.5: must be an integer", gr.plot.forces, result, ax=ax, state=1.5)
    refuses(TypeError, "must be a Result or its dataset, not str", gr.plot.forces, "result.nc", ax=ax)


def test_files_are_pictures_of_results(result, tmp_path):
    for suffix, begins in {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}.items():
        path = pictures.save(result, tmp_path / f"new/picture{suffix}", ["response"])
        assert path.read_bytes().startswith(begins)
    with pytest.raises(pictures.PictureError, match=r"picture\.jpg: format '\.jpg' is unknown, must be"):
        pictures.save(result, tmp_path / "picture.jpg", ["response"])
    (tmp_path / "folder.pdf").mkdir()
    refuses(pictures.PictureError, "cannot be written", pictures.save, result, tmp_path / "folder.pdf", ["response"])
    with pytest.raises(pictures.PictureError, match="is read by the same command"):
        pictures.save(result, path, ["response"], inputs=[path])
    assert path.read_bytes().startswith(b"<?xml")


def test_pairs_across_periodic_sides_are_two_half_lines(ax):
    position = np.array([[1.0, 1.0], [9.0, 1.0], [3.0, 1.0]])
    drawn = network.draw_contacts(ax, position, [0, 0], [1, 2], box=Box(10.0, periodic=True))
    ends = np.array(drawn.get_segments())
    np.testing.assert_allclose(ends[[0, 2], 1], [[0.0, 1.0], [10.0, 1.0]])
    np.testing.assert_allclose(ends[[1, 3], 1], [[2.0, 1.0], [2.0, 1.0]])
    point = network.pair_points(position, 1.0, [0], [1], box=Box(10.0, periodic=True))
    np.testing.assert_allclose(point, [[0.0, 1.0]])


def colours(axes) -> list[str]:
    """Of the curves of a response."""
    return [to_hex(line.get_color()) for line in axes.get_lines() if len(line.get_xdata()) == 15]


def test_curves_have_the_colours_that_are_asked_for_and_so_has_their_legend(result, ax):
    gr.plot.response(result, ax=ax, color=["tab:red", "k"], lw=3.0, ls=":")
    assert colours(ax) == [to_hex("tab:red"), to_hex("k")]
    assert [to_hex(line.get_color()) for line in ax.get_legend().get_lines()] == colours(ax)
    assert {line.get_linewidth() for line in ax.get_lines() if len(line.get_xdata()) == 15} == {3.0}
    other = style.figure()[1][0, 0]
    assert colours(gr.plot.response(result, ax=other, c="blue")) == [to_hex("blue")] * 2
    other = style.figure()[1][0, 0]
    ends = [to_hex(one) for one in matplotlib.colormaps["plasma"]([0.0, 1.0])]
    assert colours(gr.plot.response(result, ax=other, cmap="plasma")) == ends
    other = style.figure()[1][0, 0]
    with matplotlib.rc_context({"axes.prop_cycle": matplotlib.cycler(color=["#123456", "#654321"])}):
        assert colours(gr.plot.response(result, ax=other)) == ["#123456", "#654321"]


def test_a_stress_without_tension_has_a_scale_from_zero(result, ax):
    gr.plot.stress(result, ax=ax, state=0)
    mesh = ax.collections[0]
    assert (mesh.norm.vmin, mesh.get_cmap().name) == (0.0, style.SEQUENTIAL)
    assert mesh.get_array().min() >= 0.0
    other = style.figure()[1][0, 0]
    gr.plot.stress(result, ax=other, component="xz")
    assert other.collections[0].get_cmap().name == style.SIGNED
    assert any("dotted: " in text.get_text() for text in other.texts)


def test_a_result_shows_itself_in_a_notebook(result, loadless, monkeypatch):
    """Notebooks take the text of HTML before the picture, so the picture is in it; it is drawn once."""
    drawn = []
    real = pictures.page
    monkeypatch.setattr(pictures, "page", lambda *given, **options: drawn.append(given[1]) or real(*given, **options))
    for one, what in ((gr.Result(dataset=result.to_dataset()), "response"),
                      (gr.Result(dataset=loadless.to_dataset()), "floor")):  # fmt: skip
        png = one._repr_png_()
        assert png.startswith(b"\x89PNG") and one._repr_png_() is png
        text = one._repr_html_()
        assert base64.b64encode(png).decode() in text and "<table>" in text
        assert drawn.pop() == [what, "forces"] and not drawn
    monkeypatch.setattr(pictures, "MOST_DISKS", 10)
    assert gr.Result(dataset=result.to_dataset())._repr_png_() and drawn == [["response"]]


@pytest.mark.parametrize("backend", ["no-such-backend", "module://no.such.module"])
def test_the_backend_of_a_notebook_does_not_reach_a_command(backend, result, tmp_path):
    """A notebook sets MPLBACKEND for all that it starts, also where its backend is not installed."""
    result.save(tmp_path / "result.nc")
    command = [sys.executable, "-m", "granular_response", "plot", "result.nc", "-o", "page.pdf", "--animate", "a.gif"]
    environment = {**os.environ, "MPLBACKEND": backend}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr, done.stdout.split()) == (0, "", ["page.pdf", "a.gif"])
    assert (tmp_path / "page.pdf").read_bytes().startswith(b"%PDF")
    command = [sys.executable, "-m", "granular_response_paper", "draw", "theory", "--data", "no.nc"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "no.nc" in done.stderr and "backend" not in done.stderr
