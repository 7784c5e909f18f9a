"""A disordered packing at rest is in equilibrium, overlaps no more than its forces need, and weighs what it weighs.

Measured anew from positions by the audit of stored states, which ``tests/unit/test_audit.py`` tries on wrong ones.
"""

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR
from granular_response_paper.trials.random_scenes import check, contradiction, rounding_of

CASES = [(0.25, 0.0, 2.0), (0.25, 0.2, 2.0), (0.25, 1.0, 2.0), (0.1, 0.2, "touching-largest"), (0.01, 0.0, 2.0)]


@pytest.fixture(scope="module", params=CASES, ids=str)
def packing(request):
    polydispersity, friction, lattice_constant = request.param
    scene = Scene().updated(
        {
            "packing.layers": 8,
            "packing.disks_per_row": 17,
            "packing.polydispersity": polydispersity,
            "packing.lattice_constant": lattice_constant,
            "contact.friction": friction,
            "wall.friction": friction,
            "loads": [],
            "protocol.integrator": "verlet",
            "protocol.time_step": "auto",
        }
    )
    return solve_scene(scene)


def test_what_a_packing_says_of_itself_is_so_over_all_pairs_of_disks(packing) -> None:
    """In balance, no overlap without its force, no contact that is not listed, nothing lost or in flight."""
    rest = packing.rest
    found = check(packing, rest)
    assert contradiction(rest, found, rounding_of(packing)) == ""
    assert max(found.force_residual, found.torque_residual, found.coulomb_excess) < 1e-9
    assert found.force_mismatch < 1e-9
    assert found.unlisted == found.stale_springs == found.escaped == found.in_flight == 0
    assert rest.certificate.stable and rest.certificate.smallest_normal_force > 0.0
    assert np.all(rest.velocity == 0.0)
    assert rest.pairs.normal_force.max() < packing.problem.packing.mass.sum()


def test_floor_and_walls_bear_the_weight(packing) -> None:
    problem, rest = packing.problem, packing.rest
    vertical = rest.wall_force()[:, 1]
    weight = float(problem.packing.mass.sum())
    np.testing.assert_allclose(vertical.sum(), weight, rtol=1e-11)
    on_floor = float(vertical[rest.walls.second == FLOOR].sum())
    if problem.wall_friction:
        assert 0.5 * weight < on_floor
        assert abs(on_floor - weight) > 1e-6  # side walls bear a part of it
    else:
        np.testing.assert_allclose(on_floor, weight, rtol=1e-11)
