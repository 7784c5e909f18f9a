"""Problem arrays: candidates, springs carried from list to list, loads."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene, shaken

from granular_response.scene import Scene, SceneError
from granular_response.solvers.candidates import list_candidates
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.solvers.springs import carry_springs
from granular_response.solvers.system import StaticSystem
from granular_response.state import FLOOR


def test_relisting_carries_every_spring():
    problem = Problem.from_scene(scene(wall__friction=0.3))
    state = shaken(problem)
    rng = np.random.default_rng(0)
    mixed = rng.permutation(len(state.pairs.first))
    shuffled = replace(
        state, pairs=type(state.pairs)(*(getattr(state.pairs, f)[mixed] for f in state.pairs.__dataclass_fields__))
    )
    back = problem.relisted(shuffled)
    held = {(i, j): s for i, j, s in zip(state.pairs.first, state.pairs.second, state.pairs.spring, strict=True) if s}
    found = {(i, j): s for i, j, s in zip(back.pairs.first, back.pairs.second, back.pairs.spring, strict=True) if s}
    assert len(held) > 20 and found == held
    assert np.array_equal(back.walls.spring, state.walls.spring)


def test_a_lost_spring_is_an_error():
    problem = Problem.from_scene(scene())
    state = shaken(problem)
    with pytest.raises(ValueError, match="carries a spring but is not listed"):
        carry_springs(problem.n, state.pairs, state.pairs.first[5:], state.pairs.second[5:])
    with pytest.raises(ValueError, match="carries a spring but is not listed"):
        carry_springs(problem.n, state.pairs, np.zeros(0, int), np.zeros(0, int))


@pytest.mark.parametrize("move", [0.0, 0.05, 0.6])
def test_candidates_hold_every_contact_within_their_limit(move):
    problem = Problem.from_scene(scene())
    rng = np.random.default_rng(2)
    position = problem.packing.position + rng.uniform(-move, move, (problem.n, 2))
    c = list_candidates(problem.packing, problem.laws[0], position)
    assert c.limit > 0.2
    step = rng.normal(size=(50, problem.n, 2))
    step *= 0.999 * c.limit / np.linalg.norm(step, axis=2, keepdims=True)
    listed = {*zip(c.first.tolist(), c.second.tolist(), strict=True)}
    walls = {*zip(c.wall_disk.tolist(), c.wall.tolist(), strict=True)}
    for x in position + step:
        distance = np.linalg.norm(x[:, None] - x[None], axis=2)
        touching = {*zip(*(k.tolist() for k in np.nonzero(np.triu(distance < 2.0, 1))), strict=True)}
        assert touching <= listed
        for wall in range(3):
            gap = problem.packing.box.wall_gap(x, np.ones(problem.n), np.full(problem.n, wall))
            assert {(k, wall) for k in np.flatnonzero(gap < 0).tolist()} <= walls


def test_slots_of_no_listed_pair_have_no_reach():
    """Runs are lengthened for vector instructions, over pairs that may be listed elsewhere: these must never touch."""
    problem = Problem.from_scene(scene(7, 30))
    c = list_candidates(problem.packing, problem.laws[0], problem.packing.position)
    empty = np.setdiff1d(np.arange(len(c.reach)), c.slot)
    assert len(empty) and not c.reach[empty].any()
    assert np.array_equal(c.reach[c.slot], problem.packing.radius[c.first] + problem.packing.radius[c.second])


def test_a_wall_that_is_met_and_not_listed_is_noticed():
    problem, state = free_disks([[10.0, 1.0]], width=20.0)
    system = StaticSystem(problem, state)
    assert system.wall.tolist() == [FLOOR]
    q = np.zeros(system.dof)
    assert not system.meets_unlisted(q)
    q[0] = -9.5
    assert system.meets_unlisted(q)


@pytest.mark.parametrize("smooth", [{"contact.friction": 0.0}, {"contact.stiffness_ratio": 0.0}])
def test_a_torque_that_nothing_can_balance_is_refused(smooth):
    loads = [{"disk": 3, "force": [0.0, -1.0], "torque": 0.5}]
    with pytest.raises(SceneError, match=r"loads\[0\]\.torque = 0\.5: must be 0 without friction and tangential"):
        scene(loads=loads).updated(smooth)


def test_a_period_in_which_the_two_largest_disks_may_meet_on_both_sides_is_refused():
    def problem(width):
        sides = {"width": width, "sides": "periodic"}
        return Problem.from_scene(
            Scene.from_arrays([1.2, 3.5, 2.2], [1.2, 1, 3], [1.2, 1.0, 0.8], **sides, scene={"loads": []})
        )

    for width in (4.1, 5.5):
        said = rf"packing.width: the period is {width} mean radii, must be at least 5.6 for disks of this size"
        with pytest.raises(SceneError, match=said):
            problem(width)
    assert problem(5.7).n == 3


@pytest.mark.parametrize("width", [2.0, 2.2, 2.5, 2.59, 2.7, 5.0])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_one_disk_between_periodic_sides_does_not_meet_itself(width, friction):
    rubs = {"contact": {"friction": friction}, "wall": {"friction": friction}, "loads": []}
    solution = solve_scene(Scene.from_arrays([1], [1], 1, width=width, sides="periodic", scene=rubs))
    assert len(solution.rest.pairs.first) == 0
    np.testing.assert_allclose(solution.rest.wall_force(), [[0.0, 1.0]], atol=1e-9)
