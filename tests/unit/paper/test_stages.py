"""Stages of a figure group that is made up for it: simulated, drawn, interrupted; progress on a terminal."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from rich.console import Console

from granular_response.api import terminal
from granular_response.scene.base import Description
from granular_response.store import files as store
from granular_response.sweeps.resources import Resources, current
from granular_response_paper import captions
from granular_response_paper import cli as paper
from granular_response_paper.captions import Caption
from granular_response_paper.pipeline import drawing, simulation
from granular_response_paper.registry import Collection, GroupError

LABEL = {"long_name": "square", "units": "1"}


def square(item):
    return item * item


class Study:
    """Stands where the modules of a figure group would."""

    class Parameters(Description):
        count: int
        method: str

    @staticmethod
    def simulate(parameters):
        from granular_response.sweeps.tasks import map_tasks

        squares = map_tasks(square, range(parameters.count))
        return {"squares": xr.Dataset({"square": ("item", np.array(squares), LABEL)})}

    @staticmethod
    def draw(datasets):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(2, 2))
        figure.add_subplot().plot(datasets["squares"]["square"])
        return {"fig99_squares": figure}

    def captions(datasets, parameters):
        return {"fig99_squares": Caption(f"{parameters.count} squares.", "A parabola.", {"force": [1.0, 2.0]})}


@pytest.fixture
def group(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "params.yaml").write_text("common: {method: auto}\nsquares: {count: 4}\n")

    def member(group, module, name, optional=False):
        return getattr(Study, name, None) if optional else getattr(Study, name)

    for module in (simulation, drawing):
        monkeypatch.setattr(module, "group_member", member)
    small = Collection("small", "granular_response_paper", ".", "a small collection")
    for module in (simulation, paper):
        monkeypatch.setattr(module, "collection_of", lambda group: small)
    monkeypatch.setattr(captions, "question", lambda group: "How do squares grow?")
    return "squares"


def test_a_group_has_the_common_parameters_and_its_own(group):
    given, described = simulation.parameters(group)
    assert given == {"count": 4, "method": "auto"} and described == Study.Parameters(count=4, method="auto")
    with pytest.raises(GroupError, match=r"params.yaml: section cubes is missing"):
        simulation.parameters("cubes")


def test_further_formats_are_written_on_request(group, tmp_path):
    simulation.simulate(group, workers=1)
    (svg,) = [path for path in drawing.draw(group, None, tmp_path / "all", ["svg", "pdf"]) if path.suffix == ".svg"]
    assert svg.read_text().startswith("<?xml")
    assert svg.with_suffix(".pdf").read_bytes().startswith(b"%PDF") and svg.with_suffix(".png").exists()
    with pytest.raises(GroupError, match="formats: bmp is unknown, must be among png, pdf, svg"):
        drawing.draw(group, None, tmp_path / "other", ["bmp"])
    assert not (tmp_path / "other").exists()


def test_simulate_and_draw(group, tmp_path):
    assert simulation.simulate(group, workers=1) == Path("data/squares.nc")
    assert store.read("data/squares.nc")["squares"]["square"].values.tolist() == [0, 1, 4, 9]
    attributes = store.read_attributes("data/squares.nc")
    assert yaml.safe_load(attributes["parameters"])["count"] == 4
    paths = drawing.draw(group)
    assert sorted(map(str, paths)) == [f"figures/squares/{name}" for name in ("captions.json", "fig99_squares.png")]
    assert json.loads(Path("figures/squares/captions.json").read_text()) == {
        "fig99_squares": {
            "figure": 99,
            "title": "",
            "question": "How do squares grow?",
            "panels": [],
            "caption": "4 squares. F_ext = 1 and 2 m\u0304g.",
            "alternative": "A parabola.",
            "parameters": {"force": [1.0, 2.0]},
        }
    }
    before = [path.read_bytes() for path in paths]
    first = Path("data/squares.nc").read_bytes()
    simulation.simulate(group, workers=1)
    assert Path("data/squares.nc").read_bytes() == first
    assert [path.read_bytes() for path in drawing.draw(group)] == before
    assert sorted(path.name for path in (tmp_path / "data").iterdir()) == ["squares.nc"]


def test_a_second_run_beside_the_first_gives_the_same_file(group):
    """The one that ends first takes away what the other keeps, which costs the other nothing but that."""
    made = []

    def second(done, total, what=""):
        if done == 2 and not made:
            made.append(simulation.simulate(group, workers=1).read_bytes())

    simulation.simulate(group, workers=1, progress=second)
    assert made == [Path("data/squares.nc").read_bytes()]
    assert sorted(path.name for path in Path("data").iterdir()) == ["squares.nc"]


def test_an_interruption_and_what_goes_on_from_it_are_said(group, monkeypatch, capsys):
    def interrupt(done, total, what=""):
        if done == 2:
            raise KeyboardInterrupt

    whole = simulation.simulate
    monkeypatch.setattr(simulation, "simulate", lambda *args, **kind: whole(*args, **{**kind, "progress": interrupt}))
    with pytest.raises(KeyboardInterrupt, match=r"^2 finished tasks are kept and are not run again$"):
        paper.simulate(group, workers=1, params=simulation.PARAMETERS)
    assert len(list(Path("data/.squares.checkpoint").rglob("*.kept"))) == 2
    assert not Path("data/squares.nc").exists() and current() == Resources()
    monkeypatch.setattr(simulation, "simulate", whole)
    paper.simulate(group, workers=1, params=simulation.PARAMETERS)
    again = capsys.readouterr()
    assert again.err == "2 of 4 kept\n"
    assert not Path("data/.squares.checkpoint").exists()
    paper.simulate(group, workers=1, params=simulation.PARAMETERS)
    assert capsys.readouterr().err == ""


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A list with the time, which passes where a test says so."""
    now = [1000.0]
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now[0])
    return now


def test_progress_on_a_terminal_shows_time_left_after_a_while(monkeypatch, clock):
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    console = Console(file=stream, width=100, color_system=None, get_time=lambda: clock[0])
    with terminal.TerminalProgress(console) as progress:
        progress(0, 4, "paths")
        assert stream.getvalue() == ""
        clock[0] += 3.0
        progress(1, 4, "paths")
        for done in range(3):
            clock[0] += 10.0
            progress(done, 4, "scenes")
    shown = stream.getvalue()
    for part in ("paths", "scenes", "50 %", "left 0:00:20"):
        assert part in shown


@pytest.mark.parametrize(
    ("stream", "variables"),
    [(io.StringIO, {}), (io.StringIO, {"FORCE_COLOR": "1"}), (Terminal, {"TERM": "dumb"})],
    ids=["file", "file with forced colours", "dumb terminal"],
)
def test_where_no_bar_can_move_there_is_a_line_a_minute_and_what_is_kept_at_once(monkeypatch, clock, stream, variables):
    monkeypatch.setenv("TERM", "xterm")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    log = stream()
    with terminal.TerminalProgress(Console(file=log)) as progress:
        progress(206, 400, "kept")
        assert log.getvalue() == "206 of 400 kept\n"
        for done in range(206, 401):
            progress(done, 400, "scenes")
            clock[0] += 1.0
    assert log.getvalue().splitlines()[1:] == [f"scenes: {206 + k} of 400, {k} s" for k in (60, 120, 180)]
