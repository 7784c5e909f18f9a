"""Stress tests: time steps, energy, rolling, and random scenes whose results are checked from positions alone."""

import re
from dataclasses import replace

import numpy as np
import pytest
import unlike_scenes
from places import DATA, ROOT
from stress import closed_forms, random_scenes
from stress.time_steps import BLOWS_UP, CYCLES, SETTLES, tried

from granular_response.inputs import read_json
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene

SEED = 20260101
#: Of a system without dashpots: time step per limit of velocity Verlet, and the velocity of the kick, in mean overlaps
#: times the frequency of a contact.
PART, KICK = 0.05, 1.0
SMALL = {"packing": {"kind": "slab", "layers": 4, "disks_per_row": 7}, "loads": []}

# Time steps


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"contact.normal_stiffness": 1e6},
        {"contact.stiffness_ratio": 0.0},
        {"contact.stiffness_ratio": 2.0},
        {"contact.damping_ratio": 0.0},
        {"contact.friction": 100.0, "wall.friction": 100.0},
        {"packing.polydispersity": 0.5},
        {"wall.normal_stiffness": 6e4},
        {"loads": [{"disk": "top-centre", "force": [0.0, -50.0]}]},
    ],
    ids=lambda changes: ", ".join(changes) or "as it is",
)
def test_the_predicted_time_step_is_neither_too_long_nor_much_too_short(integrator, changes):
    if integrator == "leapfrog" and changes == {"contact.damping_ratio": 0.0}:
        changes = {"contact.damping_ratio": 0.02}  # it adds no damping of its own: without any, no kick dies out
    scene = Scene.from_dict(SMALL).updated({**changes, "protocol.time_step": "auto"})
    below, beyond = tried(scene, integrator, (0.95, 2.0), 4000, SEED)
    assert below == SETTLES and beyond in (CYCLES, BLOWS_UP)


# Energy


def test_the_papers_equation_for_the_spring_taken_literally_does_gain_energy():
    """It freezes a spring beyond the limit and leaves its force: that is why it is not the default."""
    undamped = Scene().updated({"contact": {"friction": 1.0, "damping_ratio": 0.0}, "wall.friction": 1.0, "loads": []})
    literal, cut = (
        closed_forms.collision(undamped.updated({"protocol.friction_law": rule}), 85.0, 3.0, 1e-4, pair=False)
        for rule in ("literal", "cut")
    )
    assert literal > 1.3 and cut < 1.0 + 3e-5


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_undamped_energy_stays_and_friction_only_takes_it(integrator):
    base = Scene.from_dict(SMALL)

    def change(friction: float, part: float, system: str = "slab") -> np.ndarray:
        scene = base.updated({"contact.friction": friction})
        return closed_forms.drift(scene, system, integrator, part, 5.0, KICK, SEED)

    for system in ("slab", "bouncing disk"):
        coarse, fine = (np.abs(change(0.0, p, system)).max() for p in (2.0 * PART, 0.5 * PART))
        assert coarse < 0.02
        assert fine < 0.3 * coarse
    sliding = change(0.2, PART)
    assert np.diff(sliding).max() < 1e-4
    assert sliding[-1] < -0.9


# Results


@pytest.mark.parametrize("first", [1290, 1310, 1330])
def test_random_scenes_are_certified_or_say_clearly_what_is_wrong(first):
    """``make scenes`` tries thousands; `wrong` is the one outcome that must never be."""
    trials = [random_scenes.run(20_000, SEED, index) for index in range(first, first + 20)]
    assert [(t.message, k) for k, t in enumerate(trials) if t.outcome == "wrong"] == []
    assert sum(t.outcome == "certified" for t in trials) > 3
    assert len({t.outcome for t in trials}) > 1
    for trial in trials:
        assert trial.outcome in random_scenes.OUTCOMES
        if trial.outcome == "certified":
            assert trial.states > 0
            assert trial.force_residual < 1e-3  # a last digit of a position at a stiffness of 1e9; else 1e-8
            assert trial.message == ""
        elif trial.states == 0:
            assert trial.message
            assert "\n" not in trial.message


@pytest.mark.parametrize(
    ("changes", "of"),
    [
        ({"protocol": {"stop_kinetic_energy": 1e-5}}, range(1, 5)),
        ({"protocol": {"stop_kinetic_energy": 1.0}}, range(5, 9)),
        ({"contact": {"normal_stiffness": 4e11}}, range(9, 12)),
    ],
    ids=["warm start", "hot start", "nearly rigid"],
)
def test_statics_from_far_away_and_between_hardly_any_digits_is_not_wrong(tmp_path, changes, of):
    """Handed over while disks still move, Newton goes far; at such a stiffness a last digit of a place is a force."""
    for seed in of:
        described, table = random_scenes.draw(np.random.default_rng(seed), 5000)
        for section, values in changes.items():
            described[section] |= values
        described["protocol"] |= {"static_finish": True, "time_step": "auto"}
        if table is not None:
            random_scenes.write_table(tmp_path / "packing.csv", table)
        trial = random_scenes.attempt(described, str(tmp_path))
        assert (trial.outcome != "wrong", trial.message) == (True, trial.message)


DESCRIPTION = {
    "packing": {"kind": "slab", "layers": 3, "disks_per_row": 4},
    "contact": {"friction": 0.3},
    "wall": {"friction": 0.2},
    "protocol": {"method": "auto", "integrator": "beeman", "time_step": "auto"},
}


def test_a_table_of_disks_has_twins_too(tmp_path):
    third = 1.0 + np.sqrt(3.0)
    table = np.array([(2.0, 1.0, 1.0), (4.0, 1.0, 1.0), (6.2, 1.1, 1.1), (3.0, third, 1.0), (5.1, third + 0.1, 0.9)])
    random_scenes.write_table(tmp_path / "packing.csv", table)
    described = {**DESCRIPTION, "packing": {"kind": "file", "path": "packing.csv", "width": 8.0}}
    loads = [{"disk": 3, "force": [0.1, -1.0]}, {"disk": 4, "displacement": [1e-4, None]}]
    for load in loads:
        trial = random_scenes.attempt({**described, "loads": [load]}, str(tmp_path), twin=True)
        assert (trial.outcome, trial.message) == ("certified", "")
        assert trial.twin_difference < random_scenes.TWINS


def test_a_solver_that_gives_a_wrong_answer_is_caught(tmp_path, monkeypatch):
    solve = random_scenes.solve_scene

    def wrong(scene, **keywords):
        solution = solve(scene, **keywords)
        moved = [replace(state, position=state.position * (1.0 - 1e-7)) for state in solution.loaded]
        return replace(solution, loaded=moved)

    monkeypatch.setattr(random_scenes, "solve_scene", wrong)
    trial = random_scenes.attempt(DESCRIPTION, str(tmp_path))
    assert trial.outcome == "wrong" and "force_residual is" in trial.message


def test_no_random_scene_was_solved_wrongly():
    path = DATA / "random_scenes.json"
    found = unlike_scenes.totals(path)
    assert set(found) <= set(random_scenes.OUTCOMES) - {"wrong"}
    outcomes = read_json(path)["outcomes"]
    assert {kind.removesuffix(unlike_scenes.ROLL) for kind in outcomes} == set(unlike_scenes.KINDS)
    rolls = [one for kind, one in outcomes.items() if kind.endswith(unlike_scenes.ROLL)]
    resist = [sum(sum(one.values()) for one in rolls), sum(one["certified"] for one in rolls)]
    page = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    (paragraph,) = (part for part in re.split(r"\n\n|\n\* ", page) if "`tests/data/random_scenes.json`" in part)
    said = [int(number.replace(",", "")) for number in re.findall(r"(?<![\w.])\d[\d,]*(?=\s)", paragraph)]
    assert said[:5] == [sum(found.values()), found["certified"], unlike_scenes.STEPS, *resist]
