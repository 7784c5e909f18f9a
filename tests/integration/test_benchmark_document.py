"""Benchmarks: the scripts run, and their page says what the stored JSON files say, nothing drawn or written by hand."""

from __future__ import annotations

import copy
import importlib
import json

import numpy as np
import pytest
from places import ROOT

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
    costs = (ROOT / "docs" / "_generated" / "costs.md").read_text(encoding="utf-8")
    assert costs == f"{document.costs(found)}\n" and costs.count("\n") == 2 + len(document.SIZES)


def test_a_missed_goal_and_a_missing_benchmark_are_said(document):
    found = copy.deepcopy(document.read())
    rows = {row["what"]: row for row in document.goals(found)}
    kept = rows["Speed of a step over LAMMPS, friction, 908 disks"]
    assert kept["goal"] == "at least 10.0 times" and kept["met"] in (True, False)
    for run in found["kernel"]["runs"]:
        run["over_lammps"] = 1.5
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed of a step over LAMMPS, friction, 908 disks"]["met"] is False
    assert "1.5 times — **missed**" in document.text(found)
    del found["kernel"]
    assert "Not measured yet" in document.text(found)
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed of a step over LAMMPS, friction, 908 disks"]["measured"] == "not measured"


@pytest.mark.parametrize(
    ("file", "rows", "said"),
    [
        ({"measured_on": "A"}, [{}, {}], "A"),
        ({"measured_on": "A"}, [{"measured_on": "A"}, {"measured_on": "B"}], "A and B"),
        ({"measured_on": "A"}, [{"measured_on": "A"}, {}], "A and a processor that was not recorded"),
        ({}, [{}], "a processor that was not recorded"),
    ],
)
def test_a_section_says_what_it_was_measured_on(document, file, rows, said):
    """Also where some rows were kept from an earlier measurement."""
    assert document.measured_on({**file, "runs": rows}) == said


def test_the_page_says_what_its_sections_were_measured_on(document):
    found = document.read()
    text = document.text({"machine": found["machine"], "scale": found["scale"]})
    assert f"The processor is {document.measured_on(found['scale'])} unless the section names another." in text


def test_what_was_measured_is_written_with_the_processor(script, tmp_path):
    timing = script("timing")
    timing.write(str(tmp_path / "a.json"), {"runs": [1.23456789]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"measured_on": timing.processor(), "runs": [1.23457]}
    timing.write(str(tmp_path / "b.json"), {"goals": []}, measured=False)
    assert json.loads((tmp_path / "b.json").read_text()) == {"goals": []}


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


def test_shares_of_a_solution_are_whole_and_of_the_right_parts(script):
    shares, timing = script("shares"), script("timing")
    falls = timing.scene(0.2).updated({"packing.layers": 10, "packing.disks_per_row": 21})
    row = shares.measure("a fall", lambda: shares.settled(falls))
    assert sum(row[part] for part in (*dict(shares.PARTS), shares.REST)) == pytest.approx(1.0)
    assert row["dynamics"] > 0.5
    assert shares.part_of("~") == "matrices and arrays"
    assert shares.part_of("src/granular_response/solvers/path/landing.py") == shares.REST


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


@pytest.fixture
def nothing_installed(script, monkeypatch):
    """No other code."""
    monkeypatch.delenv("ARENA_LMP", raising=False)
    monkeypatch.setattr(script("peers").shutil, "which", lambda name: None)


NAMES = ["LAMMPS", "newest LAMMPS", "LIGGGHTS", "YADE"]


def test_codes_that_are_not_installed_are_named(script, nothing_installed, monkeypatch, tmp_path, capsys):
    arena = script("arena")
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


def test_responses_of_ours_alone_come_within_their_errors(script, nothing_installed, monkeypatch, tmp_path):
    responses = script("responses")
    monkeypatch.setattr(responses, "REPEATS", 1)
    monkeypatch.setattr(responses.precision, "SCENES", {"frictionless": (0.0, 4.0)})
    monkeypatch.setattr(responses, "OURS", {"frictionless": {"minimisation": [{"method": "auto"}]}})
    responses.main(str(tmp_path / "responses.json"))
    found = json.loads((tmp_path / "responses.json").read_text())
    (row,) = found["reached"]
    assert row["least_error"] < 1e-9
    assert row["1e-05"] == found["runs"][0]["processor"] > 0.0


def test_the_least_time_within_an_error_is_of_the_runs_within_it(script):
    runs = [
        {"scene": "s", "code": "c", "error": error, "seconds": 9.0, "processor": time}
        for error, time in ((5e-3, 1.0), (5e-4, 4.0), (2e-4, 3.0))
    ]
    (row,) = script("responses").reached(runs)
    assert (row["0.01"], row["0.001"], row["0.0001"], row["least_error"]) == (1.0, 3.0, None, 2e-4)


def test_a_bounce_never_gains_energy_and_slides_as_the_closed_form_says(script):
    bounce, bounces = script("bounce"), script("bounces")
    after = bounce.our_bounce(bounce.DAMPING[0])
    kept, slid = bounce.energy(after), bounce.sliding(after)
    assert (kept < 1.0).all()
    # from where no spring holds the rim: tan(angle) = friction (1 + e) (1 + 1 / inertia) = 3
    steep = np.tan(np.radians(bounce.ANGLES)) > 3.0
    assert steep.sum() >= 5
    assert kept[steep] == pytest.approx(slid[steep], abs=bounces.SLID)
    assert (np.abs(kept - slid)[bounce.ANGLES < 60.0] > 1e-2).all()
    damped = bounce.our_bounce(bounce.DAMPING[1])
    assert (bounce.energy(damped) < 1.0).all()
    # a linear spring and dashpot along the normal, until their spring is at rest length
    assert -damped.velocity[:, 1] / bounce.incoming()[:, 1] == pytest.approx(0.163, abs=1e-3)


def test_stored_bounces_agree_with_codes_that_have_the_same_law(document):
    compared = {row["code"]: row for row in document.read()["bounces"]["compared"]}
    for code in ("LAMMPS, granular", "newest LAMMPS, granular", "LAMMPS, hooke/history"):
        assert max(compared[code]["from_ours_weak"], compared[code]["from_ours_strong"]) < 1e-3
        assert abs(compared[code]["excess"]) < 1e-5
    # what lammps/lammps#5007 is about
    assert compared["newest LAMMPS, hooke/history"]["excess"] > 0.05


def test_the_fastest_version_and_style_of_a_code_is_quoted(document):
    steps = [
        ("granular_response", 1.0),
        ("LAMMPS, granular", 18.0),
        ("newest LAMMPS, hooke/history", 11.4),
        ("YADE", 53.0),
    ]
    reached = [
        ("granular_response, load path", 2.0),
        ("granular_response, dynamics", 1.0),
        ("LAMMPS", 9.0),
        ("YADE", None),
    ]
    found = {
        "arena": {"runs": [{"disks": 908, "code": code, "times_ours": times} for code, times in steps]},
        "responses": {"reached": [{"scene": "friction", "code": code, "0.0001": time} for code, time in reached]},
    }
    assert [row["measured"] for row in document.over_others(found)] == [
        "LAMMPS 11.4, YADE 53",
        "friction 0.2, 15 mg, error below 1e-4: LAMMPS 9",
    ]


@pytest.mark.parametrize("friction", [0.2, 0.0])
def test_kernels_say_what_they_do(script, monkeypatch, friction):
    """What Beeman's formulas have for each unknown, and of each pair one root and one quotient."""
    limits = script("limits")
    monkeypatch.setattr(limits, "LAYERS", 4)
    monkeypatch.setattr(limits, "PER_ROW", 9)
    counts = limits.counted(friction)
    unknowns = (3 if friction else 2) * 34
    assert counts["integration"]["additions"] == 8 * unknowns
    assert counts["integration"]["multiplications"] == 9 * unknowns
    pairs = counts["pair forces"]
    assert pairs["roots"] == pairs["divisions"] > 34
    loop = limits.mix(pairs, pairs["roots"] // 8 * 8, 200, 100, 3)
    loop(2)
    assert limits.dense(2, 0, symmetric=False) == 3.0  # one quotient, one product, one difference
    assert limits.dense(60, 0, symmetric=True) == pytest.approx(60**3 / 3, rel=0.03)


def test_times_of_other_codes_come_from_their_log_and_their_stamps(script, tmp_path):
    peers = script("peers")
    log = "Loop time of 2 on 1 procs for 10 steps with 3 atoms\nLoop time of 8 on 1 procs for 20 steps with 3 atoms\n"
    (tmp_path / "processor").write_text("1000000000 7 3\n1500000000 8 4\n2000000000 9 5\n4000000000 9 6\n")
    (tmp_path / "memory").write_text("VmHWM:\t    2048 kB\n")
    used = peers.used(tmp_path, log)
    assert used.stages == [peers.Stage(10, 2.0, 0.5), peers.Stage(20, 8.0, 2.0)]
    assert used.least() == {"seconds": 0.4, "processor": 0.1, "peak_mebibytes": 2.0}
    assert used.whole() == {"steps": 30, "seconds": 10.0, "processor": 2.5}
    (tmp_path / "processor").unlink()
    assert peers.used(tmp_path, log).least()["processor"] is None


@pytest.mark.parametrize("name", ["lammps", "liggghts", "yade_dem"])
def test_other_codes_take_the_slab_and_the_load(script, name):
    code = script(name)
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


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "gear"])
def test_a_swing_has_the_stored_error(script, document, integrator):
    trajectory = script("trajectory")
    stored = document.pick(document.read()["trajectory"]["runs"], problem="swing", integrator=integrator)[0]
    assert trajectory.swing(integrator, stored["time_step"]) == pytest.approx(stored["error"], rel=1e-4)


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
