"""Certified states are in balance: forces, torques, floor forces against weight and load."""

import numpy as np
import pytest
from small_scenes import scene
from solved import FLOOR_DISKS, response, slab

from granular_response.observe.floor import floor_force
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL
from granular_response_paper.trials.random_scenes import check, contradiction, rounding_of

CASES = [(0.0, 4.0, "auto"), (0.2, 4.0, "path"), (0.2, 4.0, "dynamics"), (1.0, 4.0, "path"), (1.0, 4.0, "dynamics")]


@pytest.mark.parametrize("case", CASES)
def test_floor_carries_the_weight_and_the_load(case):
    solution = slab(*case)
    assert floor_force(solution.rest, FLOOR_DISKS).sum() == pytest.approx(908.0, rel=1e-9)
    assert floor_force(solution.loaded[-1], FLOOR_DISKS).sum() == pytest.approx(908.0 + case[1], rel=1e-9)
    assert response(solution).sum() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("case", CASES)
def test_no_disk_is_out_of_balance(case):
    """By the audit, which sums forces from positions, springs and stiffnesses alone."""
    solution = slab(*case)
    for state in (solution.rest, solution.loaded[-1]):
        found = check(solution, state)
        assert found.force_residual < 1e-9 and found.coulomb_excess < 1e-9
        assert contradiction(state, found, rounding_of(solution)) == ""


def test_frictional_walls_carry_part_of_the_weight_and_balance_sideways():
    loads = [{"disk": "top-centre", "force": [1.0, -3.0], "torque": 0.5}]
    solution = solve_scene(scene(6, 11, wall__friction=0.3, loads=loads))
    state, problem = solution.loaded[-1], solution.problem
    force = state.wall_force()
    assert force.sum(axis=0) == pytest.approx([-1.0, problem.n + 3.0], abs=1e-9)
    sides = np.isin(state.walls.second, [LEFT_WALL, RIGHT_WALL])
    assert abs(force[sides, 1].sum()) > 1e-3
    # Torque about the corner of the box: weights, load, wall forces. Both disks of a contact feel R f_t, although
    # their centres are closer than two radii by the overlap: the difference is what is left.
    x, z = state.position.T
    total = -(problem.weight * x).sum() + 0.5
    k = problem.load_disk[0]
    total += x[k] * -3.0 - z[k] * 1.0
    arm = {FLOOR: (0.0, -1.0), LEFT_WALL: (-1.0, 0.0), RIGHT_WALL: (1.0, 0.0)}
    for disk, wall, (fx, fz) in zip(state.walls.first, state.walls.second, force, strict=True):
        px, pz = state.position[disk] + arm[int(wall)]
        total += px * fz - pz * fx
    left = (np.maximum(state.pairs.overlap, 0.0) * state.pairs.tangential_force).sum()
    assert abs(left) > 1e-7
    assert total == pytest.approx(left, abs=1e-10)
