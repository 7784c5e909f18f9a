"""Animations of a growing load: a frame for each load, on one scale, in a file that is whole or not there."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import granular_response as gr
from granular_response.plot import animation

SCENE = {
    "packing": {"kind": "slab", "layers": 5, "disks_per_row": 11},
    "contact": {"friction": 0.0},
    "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
}
FORCES = [0.2, 0.4, 3.0, 6.0]


@pytest.fixture(scope="module")
def result() -> gr.Result:
    return gr.solve(SCENE, load_factors=FORCES)


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_a_file_has_a_frame_for_each_load(result, ending: str, tmp_path) -> None:
    path = tmp_path / f"growing.{ending}"
    gr.plot.animate(result, output=path, dpi=40, figure=Figure())
    with Image.open(path) as image:
        assert image.n_frames == len(FORCES)
        assert image.size == tuple(int(40 * inches) for inches in animation.Frames(result).figure.get_size_inches())
        frames = []
        for k in range(image.n_frames):
            image.seek(k)
            frames.append(np.asarray(image.convert("RGB"), dtype=int))
    assert all(np.abs(one - frames[0]).max() > 50 for one in frames[2:])  # contacts have opened
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
    gr.plot.animate(result, output=tmp_path / "growing.html", dpi=30, figure=Figure())
    assert (tmp_path / "growing.html").read_text().count("data:image/png;base64") == len(FORCES)
    assert path.read_bytes() == animation.rendered(gr.plot.animate(result, figure=Figure()), f".{ending}", dpi=40)


def test_scales_and_places_are_those_of_all_frames(result) -> None:
    frames = animation.Frames(result, figure=Figure())
    seen = set()
    for k in range(frames.count):
        frames.draw(k)
        frames.figure.canvas.draw()
        seen.add(tuple((axes.get_xlim(), axes.get_ylim(), axes.get_position().bounds) for axes in frames.figure.axes))
        (curve,) = frames.panels[1, 0].lines
        np.testing.assert_array_equal(curve.get_ydata(), result.floor_response.values[k])
    assert len(seen) == 1
    _, (_, (low, high), _) = next(iter(seen))
    assert low <= result.floor_response.values.min() and high >= result.floor_response.values.max()


def peaks(data) -> str:
    frames = animation.Frames(data, figure=Figure())
    frames.draw(0)
    return " ".join(text.get_text() for text in frames.panels[1, 0].texts if "peak" in text.get_text())


def test_peaks_at_the_side_walls_do_not_count(result) -> None:
    data = result.to_dataset()
    at_wall, inside = (data["floor_response"].where(data["floor_disk"] != data["floor_disk"][k], 0.25) for k in (1, 3))
    assert peaks(data) == peaks(data.assign(floor_response=at_wall)) == "1 peak"
    assert peaks(data.assign(floor_response=inside)) == "2 peaks"


def test_where_floor_disks_have_no_order_along_x_there_is_no_number_of_peaks(result) -> None:
    data = result.to_dataset()
    assert peaks(data.assign_coords(x=data["x"].where(data["x"].round() != 2.0, 0.0))) == ""


def widths(frames: animation.Frames) -> list[float]:
    return sorted(width for lines in frames.panels[0, 0].collections for width in np.atleast_1d(lines.get_linewidth()))


def test_in_the_linear_range_nothing_moves(result) -> None:
    """Forces are drawn per load: at twice a small load the lines are as wide, at a large one they are not."""
    frames = animation.Frames(result, figure=Figure())
    found = []
    for k in (0, 1, 3):
        frames.draw(k)
        found.append(widths(frames))
    np.testing.assert_allclose(found[1], found[0], atol=1e-3)
    assert len(found[2]) != len(found[0]) or np.abs(np.array(found[2]) - found[0]).max() > 0.1


def test_a_film_holds_its_last_frame(result, tmp_path) -> None:
    """In milliseconds; ffmpeg, where it is there, does the same by the filter that the writer asks for."""
    gr.plot.animate(result, output=tmp_path / "a.gif", dpi=30, fps=5, figure=Figure())
    with Image.open(tmp_path / "a.gif") as image:
        durations = []
        for k in range(image.n_frames):
            image.seek(k)
            durations.append(image.info["duration"])
    assert durations == [200, 200, 200, 1500]
    if animation.FFMpegWriter.isAvailable():
        gr.plot.animate(result, output=tmp_path / "a.mp4", dpi=31, fps=5, figure=Figure())
        assert b"ftyp" in (tmp_path / "a.mp4").read_bytes()[:16]
    assert "stop_duration=1.5" in " ".join(animation._Film(5.0).extra_args)
