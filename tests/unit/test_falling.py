"""What is in flight, or has not begun to move, is not at rest."""

import numpy as np
import pytest
from small_scenes import free_disks, scene

from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, Relaxation, Stop
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.solvers.timestep import resolve_time_step


def test_a_disk_that_falls_from_high_is_not_at_rest_before_it_has_landed(tmp_path):
    """Slow at first, and without a contact; it used to count as settled on the way, having touched nothing."""
    (tmp_path / "one.csv").write_text("x,z,radius\n5,10,1\n")
    packing = {"kind": "file", "path": str(tmp_path / "one.csv"), "width": 10.0}
    rest = solve_scene(Scene.from_dict({"packing": packing, "loads": [], "protocol": {"static_finish": False}})).rest
    assert rest.reached.settled
    assert rest.reached.time > np.sqrt(2.0 * 9.0)
    assert rest.position[0, 1] == pytest.approx(1.0 - 1.0 / 6000.0, abs=1e-7)


@pytest.mark.parametrize(
    "changes",
    [
        {"protocol__time_step": 4e-4},
        {"contact__normal_stiffness": 1e6, "protocol__time_step": "auto"},
        {"contact__friction": 0.2, "contact__normal_stiffness": 3e7, "protocol__time_step": "auto"},
    ],
    ids=["small step", "stiff", "stiff, with friction"],
)
def test_a_packing_in_free_fall_is_not_at_rest(changes):
    """Nearly all disks start without a contact: in their first steps they are slow, and used to count as settled."""
    gaps = {"packing__polydispersity": 0.1, "packing__lattice_constant": "touching-largest", "contact__friction": 0.0}
    problem = Problem.from_scene(scene(3, 5, **(gaps | changes)))
    dynamics = Dynamics(problem, problem.bare_state(), time_step=resolve_time_step(problem))
    run = Relaxation(dynamics, Stop(problem.plan.stop_energy))
    while dynamics.in_flight(dynamics.touching()):
        assert not run.ended
        dynamics.advance(100)
        run.look()
    assert run.dynamics.time > 0.1


def test_a_packing_pressed_together_is_not_at_rest_before_it_has_moved():
    """The literal start of a disordered packing, looked at after steps so short that nothing moves yet."""
    overlapping = {"packing__polydispersity": 0.1, "contact__friction": 0.2, "protocol__static_finish": False}
    steps = {"protocol__time_step": 1e-12, "protocol__maximum_steps": 300, "loads": []}
    assert not solve_scene(scene(**overlapping, **steps)).rest.reached.settled


def test_a_part_of_the_packing_that_nothing_bears_is_in_flight():
    together = [[10.0, 20.0], [11.9, 20.0], [30.0, 0.9]]
    problem, state = free_disks(together, loads=[{"disk": 0, "force": [0.0, 2.0]}])
    dynamics = Dynamics(problem.with_loads(state.position), state)
    assert dynamics.in_flight(dynamics.touching())
    dynamics.set_ramps(load=(1.0, 1.0, 0.0))  # as much as both weigh: they float
    assert not dynamics.in_flight(dynamics.touching())
