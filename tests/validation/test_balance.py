"""Certified states are in balance, weigh what they weigh, and stay at rest in full dynamics (claims N1 to N3).

Measured anew from positions by the audit, which ``tests/unit/test_audit.py`` tries on wrong states.
"""

import numpy as np
import pytest
from small_scenes import scene
from solved import slab
from stress.random_scenes import check, contradiction, rounding_of

from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR

SLABS = [(0.0, 4.0, "auto"), (0.2, 4.0, "path"), (0.2, 4.0, "dynamics"), (1.0, 4.0, "path"), (1.0, 4.0, "dynamics")]
#: Polydispersity, friction and lattice constant of packings at rest.
DISORDERED = [(0.25, 0.0, 2.0), (0.25, 0.2, 2.0), (0.25, 1.0, 2.0), (0.1, 0.2, "touching-largest"), (0.01, 0.0, 2.0)]


def disordered(polydispersity, friction, lattice_constant):
    packing = {"polydispersity": polydispersity, "lattice_constant": lattice_constant}
    protocol = {"integrator": "verlet", "time_step": "auto"}
    rubs = {"contact.friction": friction, "wall.friction": friction}
    return solve_scene(scene(8, 17, loads=[]).updated({"packing": packing, "protocol": protocol, **rubs}))


@pytest.fixture(scope="module", params=[*SLABS, *DISORDERED], ids=str)
def solution(request):
    return (slab if request.param in SLABS else disordered)(*request.param)


def test_what_states_say_of_themselves_is_so_over_all_pairs_of_disks(solution):
    for state in (solution.rest, *solution.loaded):
        found = check(solution, state)
        assert contradiction(state, found, rounding_of(solution)) == ""
        assert max(found.force_residual, found.torque_residual, found.coulomb_excess, found.force_mismatch) < 1e-9
        assert found.unlisted == found.stale_springs == found.escaped == found.in_flight == 0
        assert state.certificate.stable and state.certificate.smallest_normal_force > 0.0
        assert np.all(state.velocity == 0.0)


def test_floor_and_walls_carry_the_weight_and_the_load(solution):
    problem = solution.problem
    for state, load in zip((solution.rest, *solution.loaded), (0.0, 4.0), strict=False):
        vertical = state.wall_force()[:, 1]
        carried = problem.packing.mass.sum() + load
        assert vertical.sum() == pytest.approx(carried, rel=1e-9)
        on_floor = vertical[state.walls.second == FLOOR].sum()
        if problem.wall_friction:
            assert 0.5 * carried < on_floor and abs(on_floor - carried) > 1e-6  # side walls bear a part of it
        else:
            assert on_floor == pytest.approx(carried, rel=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("which", ["rest", "loaded"])
def test_a_finished_state_stays_at_rest(friction, which):
    solution = slab(friction, 4.0, "auto" if friction == 0 else "dynamics")
    state = solution.rest if which == "rest" else solution.loaded[-1]
    dynamics = Dynamics(solution.problem, state)
    dynamics.set_ramps(load=(state.load_factor, state.load_factor, 0.0))
    for _ in range(40):
        dynamics.advance(100)
        assert dynamics.kinetic_energy() < 1e-22
