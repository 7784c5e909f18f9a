"""The page of benchmarks says what the stored JSON files say, and nothing is drawn or written by hand."""

from __future__ import annotations

import copy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def document():
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        import document
    finally:
        sys.path.remove(str(ROOT / "benchmarks"))
    return document


def test_the_stored_page_is_the_one_made_from_the_stored_numbers(document):
    found = document.read()
    assert (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8") == document.text(found)
    assert document.quoted(found) in (ROOT / "README.md").read_text(encoding="utf-8")


def test_a_missed_goal_and_a_missing_benchmark_are_said(document):
    found = copy.deepcopy(document.read())
    rows = {row["what"]: row for row in document.goals(found)}
    kept = rows["Speed over LAMMPS, friction, 908 disks, one scene"]
    assert kept["goal"] == "at least 4.0 times" and kept["met"] in (True, False)
    for run in found["kernel"]["runs"]:
        run["single_over_lammps"] = 1.5
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed over LAMMPS, friction, 908 disks, one scene"]["met"] is False
    assert "1.5 times — **missed**" in document.text(found)
    del found["kernel"]
    assert "Not measured yet" in document.text(found)
    rows = {row["what"]: row for row in document.goals(found)}
    assert rows["Speed over LAMMPS, friction, 908 disks, one scene"]["measured"] == "not measured"


def test_every_stored_benchmark_is_drawn_and_named(document):
    found = document.read()
    assert set(found) <= {*document.TEXTS, "machine"}
    for benchmark in set(found) & set(document.pictures.DRAWN):
        drawn = document.pictures.DRAWN[benchmark](found[benchmark])
        assert drawn.axes and all(panel.has_data() for panel in drawn.axes)
