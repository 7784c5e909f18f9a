"""A packing of one material is settled once, and a kept rest state is exactly the computed one."""

import pickle

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solve import Problem
from granular_response.solve import solution as solve
from granular_response.sweeps import rest as settled

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
    calls = []
    original = solve.rest_state

    def count(problem):
        calls.append(problem)
        return original(problem)

    monkeypatch.setattr(solve, "rest_state", count)
    return calls


def test_without_a_folder_nothing_is_kept(monkeypatch, tmp_path, computed):
    monkeypatch.delenv(settled.FOLDER_VARIABLE, raising=False)
    monkeypatch.chdir(tmp_path)
    settled.rest_state(Problem.from_scene(SCENE))
    settled.rest_state(Problem.from_scene(SCENE))
    assert len(computed) == 2
    assert list(tmp_path.iterdir()) == []


def test_a_kept_state_is_the_computed_one(monkeypatch, tmp_path, computed):
    monkeypatch.setenv(settled.FOLDER_VARIABLE, str(tmp_path / "kept"))
    first = settled.rest_state(Problem.from_scene(SCENE))
    again = settled.rest_state(Problem.from_scene(SCENE.updated({"loads.0.force": [1.0, -2.0]})))
    assert len(computed) == 1
    assert pickle.dumps(again) == pickle.dumps(pickle.loads(pickle.dumps(first)))
    np.testing.assert_array_equal(again.pairs.spring, first.pairs.spring)


def test_a_minimised_packing_needs_no_stable_time_step(monkeypatch, tmp_path, computed):
    """The step of the scene is too long for disks this stiff, but no step is taken."""
    monkeypatch.setenv(settled.FOLDER_VARIABLE, str(tmp_path / "kept"))
    stiff = {"contact.friction": 0.0, "contact.normal_stiffness": 1e6, "protocol.time_step": 1e-3}
    for _ in range(2):
        state = settled.rest_state(Problem.from_scene(SCENE.updated(stiff)))
        assert state.certificate.force_residual < 1e-9
    assert len(computed) == 1


@pytest.mark.parametrize(
    "change",
    [
        {"contact.friction": 0.5},
        {"wall.friction": 0.1},
        {"preparation.gravity": "slow"},
        {"packing.disks_per_row": 8},
        {"protocol.friction_law": "literal"},
        {"protocol.integrator": "verlet"},
        {"protocol.time_step": 4e-4},
        {"protocol.stop_kinetic_energy": 1e-10},
        {"protocol.static_finish": False},
    ],
)
def test_what_changes_the_rest_state_changes_its_name(change):
    assert settled.name(Problem.from_scene(SCENE.updated(change))) != settled.name(Problem.from_scene(SCENE))


@pytest.mark.parametrize("change", [{"loads.0.torque": 3.0}, {"protocol.ramp_time": 50.0}, {"protocol.method": "path"}])
def test_what_comes_after_rest_does_not(change):
    assert settled.name(Problem.from_scene(SCENE.updated(change))) == settled.name(Problem.from_scene(SCENE))


def test_a_damaged_state_is_computed_again(monkeypatch, tmp_path, computed):
    monkeypatch.setenv(settled.FOLDER_VARIABLE, str(tmp_path))
    first = settled.rest_state(Problem.from_scene(SCENE))
    (kept,) = tmp_path.rglob("*.pickle")
    data = bytearray(kept.read_bytes())
    data[len(data) // 2] ^= 1
    kept.write_bytes(data)
    again = settled.rest_state(Problem.from_scene(SCENE))
    assert len(computed) == 2
    np.testing.assert_array_equal(again.position, first.position)


def test_states_of_other_solvers_go(monkeypatch, tmp_path):
    monkeypatch.setenv(settled.FOLDER_VARIABLE, str(tmp_path))
    old = tmp_path / ("a" * 32)
    old.mkdir()
    (old / "state.pickle").write_bytes(b"")
    settled.rest_state(Problem.from_scene(SCENE))
    assert not old.exists()
    assert len(list(tmp_path.rglob("*.pickle"))) == 1


def test_only_shelves_of_other_sources_are_cleared(tmp_path, monkeypatch):
    monkeypatch.setenv(settled.FOLDER_VARIABLE, str(tmp_path))
    old, thesis, odd = tmp_path / ("0" * 32), tmp_path / "thesis", tmp_path / ("1" * 32)
    for folder, file in ((old, "state.pickle"), (thesis, "chapter1.tex"), (odd, "chapter2.tex")):
        folder.mkdir()
        (folder / file).write_text("kept")
    settled.rest_state(Problem.from_scene(SCENE))
    assert not old.exists() and (thesis / "chapter1.tex").exists() and (odd / "chapter2.tex").exists()
