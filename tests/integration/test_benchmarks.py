"""Benchmarks: the scripts run, and their page says what the stored JSON files say, nothing drawn or written by hand."""

from __future__ import annotations

import importlib
import json

import numpy as np
import pytest
from places import ROOT

PEERS = [f"peers.{path.stem}" for path in (ROOT / "benchmarks" / "peers").glob("*.py")]
SCRIPTS = sorted([*PEERS, *(path.stem for path in (ROOT / "benchmarks").glob("*.py"))])


@pytest.fixture
def script(monkeypatch):
    """Imports a script as `python benchmarks/NAME.py` finds it."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    return importlib.import_module


@pytest.fixture
def document(script):
    return script("document")


@pytest.mark.parametrize("name", SCRIPTS)
def test_every_script_finds_what_it_imports(script, name):
    assert script(name).__doc__


@pytest.fixture
def nothing_installed(script, monkeypatch):
    """No other code."""
    monkeypatch.delenv("ARENA_LMP", raising=False)
    monkeypatch.setattr(script("peers.processes").shutil, "which", lambda name: None)


NAMES = ["LAMMPS", "newest LAMMPS", "LIGGGHTS", "YADE"]


def test_codes_that_are_not_installed_are_named(script, nothing_installed, monkeypatch, tmp_path, capsys):
    arena = script("peers.arena")
    monkeypatch.setattr(arena.kernel, "SLABS", [(4, 9, 100, 20)])
    monkeypatch.setattr(arena, "STEPS", {34: 20})
    monkeypatch.setattr(arena, "ROUNDS", 1)
    arena.main(str(tmp_path / "arena.json"))
    found = json.loads((tmp_path / "arena.json").read_text())
    (row,) = found["runs"]
    assert (row["code"], row["disks"], row["times_ours"]) == ("granular_response", 34, 1.0)
    assert 0.0 < row["processor_microseconds"] <= row["processor_microseconds_worst_round"]
    assert row["peak_mebibytes"] is None or row["peak_mebibytes"] > 20.0
    assert [text.partition(" (")[0] for text in found["skipped"]] == NAMES
    assert "apt-get install liggghts" in capsys.readouterr().out


def test_the_least_time_within_an_error_is_of_the_runs_within_it(script):
    runs = [
        {"scene": "s", "code": "c", "error": error, "seconds": 9.0, "processor": time}
        for error, time in ((5e-3, 1.0), (5e-4, 4.0), (2e-4, 3.0))
    ]
    (row,) = script("peers.responses").reached(runs)
    assert (row["0.01"], row["0.001"], row["0.0001"], row["least_error"]) == (1.0, 3.0, None, 2e-4)


def test_times_of_other_codes_come_from_their_log_and_their_stamps(script, tmp_path):
    processes = script("peers.processes")
    log = "Loop time of 2 on 1 procs for 10 steps with 3 atoms\nLoop time of 8 on 1 procs for 20 steps with 3 atoms\n"
    (tmp_path / "processor").write_text("1000000000 7 3\n1500000000 8 4\n2000000000 9 5\n4000000000 9 6\n")
    (tmp_path / "memory").write_text("VmHWM:\t    2048 kB\n")
    used = processes.used(tmp_path, log)
    assert used.stages == [processes.Stage(10, 2.0, 0.5), processes.Stage(20, 8.0, 2.0)]
    assert used.least() == {"seconds": 0.4, "processor": 0.1, "peak_mebibytes": 2.0}
    assert used.whole() == {"steps": 30, "seconds": 10.0, "processor": 2.5}
    (tmp_path / "processor").unlink()
    assert processes.used(tmp_path, log).least()["processor"] is None


@pytest.mark.parametrize("name", ["lammps", "liggghts", "yade_dem"])
def test_other_codes_take_the_slab_and_the_load(script, name):
    code = script(f"peers.{name}")
    command = code.executable()
    if command is None:
        pytest.skip(f"{name} is not installed")
    packing = script("kernel").slab(4, 9, 0.2).packing
    used = code.steps_used(packing, 0.2, 20, 20, 4e-4, command, 2)
    assert [stage.steps for stage in used.stages] == [20, 20, 20]
    assert 0.0 < used.least()["seconds"] < 1e-1
    top = int(np.flatnonzero(packing.row == packing.row.max())[3])
    run = code.response(packing, 0.2, top, 2.0, 1.0, 20_000, 20_000, time_step=5e-4, command=command)
    assert run.floor_rest.sum() == pytest.approx(packing.n, rel=1e-3)
    assert (run.floor - run.floor_rest).sum() == pytest.approx(2.0, rel=1e-3)


def test_the_page_has_what_is_stored(document):
    found = document.read()
    assert (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8") == document.page(found)
    assert (ROOT / "docs" / "_generated" / "costs.md").read_text(encoding="utf-8") == document.costs(found) + "\n"
    assert json.loads((ROOT / "benchmarks" / "summary.json").read_text())["goals"] == document.goals(found)
    slow = json.loads(json.dumps(found))
    slow["startup"]["runs"][0]["seconds"] = 41.0
    assert [row["what"] for row in document.goals(slow) if not row["met"]] == ["Every kernel compiled and cached"]


@pytest.mark.parametrize(("kind", "scene"), [("nine points", 0), ("small", 3), ("small", 2), ("slabs", 0)])
def test_a_path_is_as_accurate_as_stored(script, document, monkeypatch, kind, scene):
    """In few increments, since those end at events anyway. One path loses an equilibrium: which one follows is decided
    by the motion, so later events are not compared."""
    exactness = script("exactness")
    monkeypatch.setattr(exactness, "MOST", 20)
    monkeypatch.setattr(exactness, "MOST_OF_SLAB", 20)
    (stored,) = document.pick(document.read()["exactness"]["runs"], kind=kind, scene=scene)
    found = exactness.measure(kind, scene, list(exactness.SCENES[kind]())[scene])
    assert found["lost"] == stored["lost"]
    assert exactness.outcome(found) == exactness.outcome(stored)
    if exactness.outcome(found) == "none lost":
        assert found["events"] == stored["events"]
        assert max(found["error"], stored["error"]) <= exactness.EXACT
