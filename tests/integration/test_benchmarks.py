"""Benchmarks: the scripts run, and their page says what the stored JSON files say, nothing drawn or written by hand."""

from __future__ import annotations

import importlib
import json

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


def test_the_page_has_what_is_stored(document):
    found = document.read()
    assert (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8") == document.page(found)
    assert (ROOT / "docs" / "_generated" / "costs.md").read_text(encoding="utf-8") == document.costs(found) + "\n"
    assert json.loads((ROOT / "benchmarks" / "summary.json").read_text())["goals"] == document.goals(found)
    slow = json.loads(json.dumps(found))
    slow["startup"]["runs"][0]["seconds"] = 41.0
    assert [row["what"] for row in document.goals(slow) if not row["met"]] == ["Every kernel compiled and cached"]


@pytest.mark.parametrize(("kind", "scene"), [("small", 3), ("small", 2)])
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
