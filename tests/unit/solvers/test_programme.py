"""Load programmes: up, down, to zero and beyond, by every method."""

import numpy as np
import pytest
from small_scenes import scene

from granular_response.observe.floor import floor_disks, floor_force
from granular_response.scene import Scene, SceneError
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import continue_solution, solve_scene
from granular_response.solvers.timestep import resolve_time_step

LOAD = [{"disk": "top-centre", "force": [0.0, -6.0]}]
PROGRAMME = (0.5, 1.0, 0.5, 0.0, 1.0)


def under_the_load(solution) -> list[float]:
    """What the load adds to the force on the middle floor disk, in mean disk weights, in each state."""
    disks = floor_disks([solution.rest, *solution.loaded])
    middle = len(disks) // 2
    at_rest = floor_force(solution.rest, disks)[middle]
    return [float(floor_force(state, disks)[middle] - at_rest) for state in solution.loaded]


def slab(**changes) -> Scene:
    return scene(4, 9, loads=LOAD, **changes)


def test_unloading_with_friction_leads_along_another_branch():
    solution = solve_scene(slab(contact__friction=0.2, protocol__load_factors=list(PROGRAMME)))
    assert solution.load_factors == PROGRAMME
    for state in solution.loaded:
        assert state.certificate.force_residual < 1e-12 and state.certificate.stable
    loading, full, unloading, unloaded, again = under_the_load(solution)
    assert loading / 3.0 == pytest.approx(0.2919, abs=5e-4)
    assert unloading / 3.0 == pytest.approx(0.2325, abs=5e-4)
    assert unloaded == pytest.approx(-0.1126, abs=2e-3)  # friction keeps what the load has done
    assert again == pytest.approx(full, rel=0.01)


def test_a_result_holds_the_programme_that_was_solved():
    solution = solve_scene(slab(), load_factors=[0.5])
    assert solution.scene.protocol.load_factors == (0.5,)
    further = continue_solution(solution, [1, np.float64(0.25)])
    assert further.scene.protocol.load_factors == further.load_factors == (0.5, 1.0, 0.25)


def test_loads_that_go_on_are_looked_at_as_those_of_a_scene():
    """The time step of dynamics is stable for them too, and what no contact bears is refused before it is put on."""
    by_motion = {"protocol__method": "dynamics", "protocol__ramp_time": 1.0, "protocol__time_step": "auto"}
    scene = slab(contact__law="hertz", contact__friction=0.0, contact__damping_ratio=0.05, **by_motion)
    solution = solve_scene(scene, load_factors=[0.1])
    further = continue_solution(solution, [100.0])
    assert further.loaded[0].reached.time_step > further.loaded[1].reached.time_step
    whole = resolve_time_step(Problem.from_scene(scene.updated({"protocol.load_factors": [0.1, 100.0]})))
    assert further.loaded[1].reached.time_step == resolve_time_step(further.problem) == whole
    with pytest.raises(SceneError, match=r"^loads\[0\]\.force: .* must be at most"):
        continue_solution(solve_scene(slab(), load_factors=[1.0]), [1e4])


def test_loads_may_change_their_sign():
    """The slab is symmetric, and so are its answers to loads from either side, from rest."""
    pushed = scene(5, 9, loads=[{"disk": "top-centre", "force": [1.0, 0.0]}])
    right, left = (solve_scene(pushed, load_factors=[sign]) for sign in (1.0, -1.0))
    assert left.load_factors == (-1.0,)
    a, b = (
        floor_force(one.loaded[0], floor_disks([one.rest])) - floor_force(one.rest, floor_disks([one.rest]))
        for one in (right, left)
    )
    assert np.abs(a).max() > 0.05
    assert b == pytest.approx(a[::-1], abs=1e-8)


def test_dynamics_starts_from_rest_until_the_programme_turns():
    by_dynamics = slab(protocol__method="dynamics", protocol__stop_kinetic_energy=1e-9)
    both = solve_scene(by_dynamics, load_factors=(0.5, 1.0, 0.5))
    alone = solve_scene(by_dynamics, load_factors=(1.0, 0.5))
    assert np.array_equal(both.loaded[1].position, alone.loaded[0].position)
    assert np.array_equal(both.loaded[2].position, alone.loaded[1].position)
    assert not np.array_equal(both.loaded[0].position, both.loaded[2].position)
