"""A packing of one material is settled once, and a kept rest state is exactly the computed one."""

import multiprocessing
import os
import time
from pathlib import Path

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solvers import solution as solve
from granular_response.solvers.problem import Problem
from granular_response.sweeps import rest as settled
from granular_response.sweeps.keys import key
from granular_response.sweeps.memory import Memory, MemoryWarning
from granular_response.sweeps.resources import using

SCENE = Scene.from_dict(
    {
        "packing": {"kind": "slab", "layers": 4, "disks_per_row": 6},
        "contact": {"friction": 0.4},
        "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
        "protocol": {"stop_kinetic_energy": 1e-9},
    }
)


@pytest.fixture
def computed(monkeypatch):
    """How often a packing was settled."""
    return counted(monkeypatch)


def counted(monkeypatch):
    """The problems that are settled from now on."""
    calls = []
    original = solve.rest_state

    def count(problem):
        calls.append(problem)
        return original(problem)

    monkeypatch.setattr(solve, "rest_state", count)
    return calls


@pytest.fixture
def folder(tmp_path):
    """The folder of the resources in use."""
    with using(rest_states=tmp_path / "kept"):
        yield tmp_path / "kept"


def files(folder):
    return sorted(folder.rglob("*.kept"))


def test_without_a_folder_nothing_is_kept(monkeypatch, tmp_path, computed):
    monkeypatch.chdir(tmp_path)
    settled.rest_state(Problem.from_scene(SCENE))
    settled.rest_state(Problem.from_scene(SCENE))
    assert len(computed) == 2
    assert list(tmp_path.iterdir()) == []


def test_a_kept_state_is_the_computed_one(folder, computed):
    first = settled.rest_state(Problem.from_scene(SCENE))
    again = settled.rest_state(Problem.from_scene(SCENE.updated({"loads.0.force": [1.0, -2.0]})))
    assert len(computed) == 1
    assert key(again) == key(first)
    np.testing.assert_array_equal(again.pairs.spring, first.pairs.spring)


#: A change, and whether it changes the rest state of the scene, and of one that is prepared without friction: that may
#: turn away once it has friction, and dynamics takes it to rest.
CHANGES = [
    ({"contact.friction": 0.5}, True),
    ({"wall.friction": 0.1}, True),
    ({"contact.rolling_friction": 0.1, "contact.rolling_stiffness_ratio": 0.5}, True),
    ({"preparation.gravity": "slow"}, True),
    ({"packing.disks_per_row": 8}, True),
    ({"protocol.friction_law": "literal"}, True),
    ({"protocol.integrator": "verlet"}, True),
    ({"protocol.time_step": 4e-4}, True),
    ({"protocol.stop_kinetic_energy": 1e-10}, True),
    ({"protocol.static_finish": False}, True),
    ({"loads.0.torque": 3.0}, False),
    ({"protocol.ramp_time": 50.0}, False),
    ({"protocol.method": "path"}, False),
]
ROLLING = SCENE.updated({"wall.friction": 0.1, "wall.rolling_friction": 0.1, "wall.rolling_stiffness_ratio": 0.5})
DISORDERED = SCENE.updated({"packing.polydispersity": 0.1})
FRICTIONLESS = SCENE.updated({"preparation.gravity": "frictionless"})


@pytest.mark.parametrize(
    ("scene", "change", "other"),
    [
        *((SCENE, *row) for row in CHANGES),
        (ROLLING, {"wall.rolling_friction": 0.2}, True),
        (DISORDERED, {"protocol.static_finish": False}, True),
        *((FRICTIONLESS, {f"protocol.{key}": value}, True) for key, value in (
            ("static_finish", False), ("integrator", "verlet"), ("maximum_steps", 1000),
        )),
    ],
)  # fmt: skip
def test_what_changes_the_rest_state_changes_its_name_and_nothing_else_does(scene, change, other):
    names = [settled.name(Problem.from_scene(one)) for one in (scene, scene.updated(change))]
    assert (names[0] != names[1]) is other


def test_a_state_under_the_name_of_another_is_not_taken(folder, computed):
    settled.rest_state(Problem.from_scene(SCENE))
    (kept,) = files(folder)
    other = Problem.from_scene(SCENE.updated({"contact.friction": 0.5}))
    kept.with_name(f"{settled.name(other)}.kept").write_bytes(kept.read_bytes())
    with pytest.warns(MemoryWarning, match="kept: damaged results are computed again"):
        settled.rest_state(other)
    assert len(computed) == 2


def test_states_of_other_sources_go_after_a_week(folder, computed):
    new, old, thesis, odd = (folder / name for name in ("0" * 32, "1" * 32, "thesis", "2" * 32))
    for shelf, file in ((new, "a.kept"), (old, "b.kept"), (thesis, "chapter1.kept"), (odd, "chapter2.tex")):
        shelf.mkdir(parents=True)
        (shelf / file).write_text("kept")
    long_ago = time.time() - 8 * 24 * 3600
    for shelf in (old, thesis, odd):
        os.utime(shelf, (long_ago, long_ago))
    settled.rest_state(Problem.from_scene(SCENE))
    assert not old.exists() and new.exists() and thesis.exists() and odd.exists()


class Runs:
    """Reads as a call, as any pickle may."""

    def __reduce__(self):
        return (print, ("ran",))


def test_reading_a_state_runs_no_code(folder, computed, capsys):
    name = settled.name(Problem.from_scene(SCENE))
    Memory(folder, settled._PARTS).save(name, Runs())
    assert files(folder)
    with pytest.warns(MemoryWarning, match="cannot be read are computed again: UnpicklingError: builtins.print is no"):
        settled.rest_state(Problem.from_scene(SCENE))
    assert len(computed) == 1 and capsys.readouterr().out == ""


def settle_where(folder):
    """Settle in this process; the number of times that it was computed here."""
    with pytest.MonkeyPatch.context() as monkeypatch, using(rest_states=folder):
        calls = counted(monkeypatch)
        settled.rest_state(Problem.from_scene(SCENE))
    return len(calls)


def test_one_process_at_a_time_makes_a_state(tmp_path):
    """The second one waits for the first, and takes what that has made."""
    memory, name = Memory(tmp_path, settled._PARTS, states=True), settled.name(Problem.from_scene(SCENE))
    with multiprocessing.get_context("forkserver").Pool(1) as pool:
        with memory.making(name):
            found = pool.apply_async(settle_where, [tmp_path])
            lock = f":{(memory.shelf / f'{name}.lock').stat().st_ino} "
            while not any("->" in line and lock in line for line in Path("/proc/locks").read_text().splitlines()):
                assert not found.ready()
                time.sleep(0.01)
            memory.save(name, solve.rest_state(Problem.from_scene(SCENE)))
        assert found.get(timeout=600) == 0
    assert not list(tmp_path.rglob("*.lock"))


def test_a_pipe_in_the_place_of_its_lock_is_not_waited_for(folder, computed):
    memory, name = Memory(folder, settled._PARTS, states=True), settled.name(Problem.from_scene(SCENE))
    memory.shelf.mkdir(parents=True)
    os.mkfifo(memory.shelf / f"{name}.lock")
    settled.rest_of(SCENE), settled.rest_of(SCENE)
    assert len(computed) == 1
