"""Benchmarks: the scripts run, and their page says what the stored JSON files say, nothing drawn or written by hand."""

from __future__ import annotations

import copy
import importlib
import json
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


SCRIPTS = sorted(path.stem for path in (ROOT / "benchmarks").glob("*.py"))


@pytest.fixture
def script(monkeypatch):
    """Imports a script as `python benchmarks/NAME.py` finds it."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    return importlib.import_module


@pytest.fixture
def document(script):
    return script("document")


def test_the_stored_page_is_the_one_made_from_the_stored_numbers(document):
    found = document.read()
    assert (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8") == document.text(found)
    assert document.quoted(found) in (ROOT / "README.md").read_text(encoding="utf-8")


def test_a_missed_goal_and_a_missing_benchmark_are_said(document):
    found = copy.deepcopy(document.read())
    rows = {row["what"]: row for row in document.goals(found)}
    kept = rows["Speed over LAMMPS, friction, 908 disks"]
    assert kept["goal"] == "at least 10.0 times" and kept["met"] in (True, False)
    for run in found["kernel"]["runs"]:
        run["over_lammps"] = 1.5
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed over LAMMPS, friction, 908 disks"]["met"] is False
    assert "1.5 times — **missed**" in document.text(found)
    del found["kernel"]
    assert "Not measured yet" in document.text(found)
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed over LAMMPS, friction, 908 disks"]["measured"] == "not measured"


def test_every_stored_benchmark_is_drawn_and_named(document):
    found = document.read()
    assert set(found) <= {*document.TEXTS, "machine"}
    for benchmark in set(found) & set(document.pictures.DRAWN):
        drawn = document.pictures.DRAWN[benchmark](found[benchmark])
        assert drawn.axes and all(panel.has_data() for panel in drawn.axes)


@pytest.mark.parametrize("name", SCRIPTS)
def test_every_script_finds_what_it_imports(script, name):
    assert script(name).__doc__


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_kernels_are_timed_whole_and_in_parts(script, monkeypatch, friction):
    kernel = script("kernel")
    monkeypatch.setattr(kernel.lammps, "executable", lambda: None)
    monkeypatch.setattr(kernel, "REPEATS", 2)
    row = kernel.measure(4, 9, friction, 100, 20)
    assert row["disks"] == 34 and row["microseconds"] > 0.0 and row["over_lammps"] is None
    rows = kernel.profile(4, 9, friction, 100)
    assert {row["part"] for row in rows} >= {"pair forces", "wall forces", "integration", "whole step"}
    assert all(row["microseconds"] >= 0.0 for row in rows if row["microseconds"] is not None)


def test_what_skipping_forces_on_changes_no_result(script):
    skipping = script("skipping")
    _, plain = skipping.settled(0.2, 500)
    for force in (skipping.all_walls, lambda dynamics: skipping.search_often(dynamics, 200)):
        _, forced = skipping.settled(0.2, 500)
        force(forced)
        forced.advance(1000 - forced.steps)
        plain.advance(1000 - plain.steps)
        assert np.array_equal(plain.position, forced.position)


def test_factorisations_of_one_slab_agree(script):
    linear = script("linear")
    for friction in (0.2, 0.0):
        rows = linear.measure(4, 17, friction, 1)
        assert {"band, ours", "band, LAPACK", "fronts, ours", "SuperLU"} <= {row["method"] for row in rows}
        assert all(row["relative_residual"] < 1e-10 for row in rows)


def test_codes_that_are_not_installed_are_named(script, monkeypatch, tmp_path, capsys):
    arena = script("arena")
    monkeypatch.delenv("ARENA_LMP", raising=False)
    for code in (arena.lammps, arena.liggghts):
        monkeypatch.setattr(code, "executable", lambda: None)
    monkeypatch.setattr(arena.kernel, "SLABS", [(4, 9, 100, 20)])
    monkeypatch.setattr(arena, "DISKS", (34,))
    arena.main(str(tmp_path / "arena.json"))
    found = json.loads((tmp_path / "arena.json").read_text())
    assert [(row["code"], row["disks"]) for row in found["runs"]] == [("granular_response", 34)]
    assert found["runs"][0]["microseconds"] > 0.0
    assert [text.partition(" (")[0] for text in found["skipped"]] == ["LAMMPS", "LAMMPS, newest", "LIGGGHTS"]
    assert "apt-get install liggghts" in capsys.readouterr().out


@pytest.mark.parametrize("code", ["lammps", "liggghts"])
def test_other_codes_take_the_slab(script, code):
    peer = script(code)
    if peer.executable() is None:
        pytest.skip(f"{code} is not installed")
    packing = script("kernel").slab(4, 9, 0.2).packing
    assert 0.0 < peer.step_time(packing, 0.2, 10, 20, 4e-4, peer.executable(), 1) < 1e-2


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "gear"])
def test_a_swing_has_the_stored_error(script, document, integrator):
    trajectory = script("trajectory")
    stored = document.pick(document.read()["trajectory"]["runs"], problem="swing", integrator=integrator)[0]
    assert trajectory.swing(integrator, stored["time_step"]) == pytest.approx(stored["error"], rel=1e-4)
