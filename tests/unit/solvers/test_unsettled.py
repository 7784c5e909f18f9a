"""What is in flight, or has not begun to move, is not at rest; states that still move say so, and under which load."""

from dataclasses import replace

import numpy as np
import pytest
from printed import shown
from small_scenes import free_disks, scene

import granular_response as gr
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, Stop, _Relaxation, relax
from granular_response.solvers.equilibrium import certify
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.result import solution_from, state_from, to_dataset


def test_a_disk_that_falls_from_high_is_not_at_rest_before_it_has_landed():
    """Slow at first, and without a contact; it used to count as settled on the way, having touched nothing."""
    moving = {"loads": [], "protocol": {"static_finish": False}}
    rest = solve_scene(Scene.from_arrays([5.0], [10.0], 1.0, width=10.0, scene=moving)).rest
    assert rest.reached.settled
    assert rest.reached.time > np.sqrt(2.0 * 9.0)
    assert rest.position[0, 1] == pytest.approx(1.0 - 1.0 / 6000.0, abs=1e-7)


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
    for load, falls in ((1.0, False), (1.0 - 1e-14, False), (1.0 - 1e-6, True)):  # as much as both weigh: they float
        dynamics.set_ramps(load=(load, load, 0.0))
        assert dynamics.in_flight(dynamics.touching()) == falls


@pytest.mark.parametrize("gap, torn", [(4.5, None), (5.5, 1)])
def test_a_disk_is_torn_off_five_radii_above_all_others(gap, torn):
    loads = [{"disk": 1, "force": [0.0, 3.0]}]
    problem, state = free_disks([[10.0, 1.0], [10.0, 3.0 + gap]], velocity=[[0.0, 0.0], [0.0, 1.0]], loads=loads)
    dynamics = Dynamics(problem.with_loads(state.position), state)
    dynamics.set_ramps(load=(1.0, 1.0, 0.0))
    assert dynamics.lifted_disk() == torn


@pytest.mark.parametrize("times, stopped", [(5.0, None), (20.0, 1)])
def test_a_disk_that_has_ten_times_the_energy_of_those_that_bear_others_is_stopped_by_hand(times, stopped):
    """Where small accelerations end the motion: that of a disk on the floor alone says nothing."""
    row = [[1.0 + 1.999 * k, 1.0 - 1e-4] for k in range(4)]
    speed = np.array([0.0, 1.0, 1.0, 0.0, 0.0, np.sqrt(times * 2.0 / 6.0)]) * 1e-5
    disks = [*row, [60.0, 1.0 - 1e-4], [90.0, 1.0 - 1e-4]]
    problem, state = free_disks(disks, velocity=np.stack([speed, 0.0 * speed], axis=1), contact__friction=0.2)
    relaxation = _Relaxation(Dynamics(problem, state), Stop(1e-30, acceleration=1e-3), (1.0, 1.0, 0.0), (0.0, 0.0, 0.0))
    relaxation.settled = True
    assert relaxation.state().reached.stopped_rattlers == stopped


def test_one_look_in_ten_asks_what_rolls_while_a_packing_is_far_from_rest(monkeypatch):
    problem = Problem.from_scene(scene(6, 13, contact__friction=0.2))
    asked, usual = [], Dynamics.rolling
    monkeypatch.setattr(Dynamics, "rolling", lambda self, *known: asked.append(self.steps) or usual(self, *known))
    relax(Dynamics(problem, problem.bare_state()), Stop(1e-30, maximum_steps=4000))
    assert asked == [1000, 2000, 3000, 4000]


LOAD = [{"disk": "top-centre", "force": [0.0, -2.0]}]


def test_a_ramp_that_is_cut_short_carries_the_load_it_has_reached():
    """1,000 steps of 5e-4 are a fortieth of the ramp of 20; the result used to say load factor 1."""
    protocol = {"method": "dynamics", "static_finish": False, "maximum_steps": 1000, "time_step": 5e-4}
    solution = solve_scene(scene(loads=LOAD, protocol=protocol))
    assert solution.load_factors == (pytest.approx(0.025, abs=1e-6),)
    assert solution.loaded[0].reached.settled is False
    assert solution.unsettled == "not at rest within protocol.maximum_steps = 1000: gravity, load factor 0.025"
    data = to_dataset(solution)
    assert data.attrs["settled"] == "no" and data.attrs["stable"] == "no"
    assert data["total_force"].values.tolist() == [pytest.approx(0.05, abs=1e-5)]
    again = solution_from(data)
    assert again.unsettled == solution.unsettled
    assert solve_scene(scene(loads=LOAD)).unsettled == ""


def test_a_path_from_a_start_that_is_not_in_balance_begins_with_an_equilibrium():
    """Dynamics alone stops with something left; a first load factor of 0 returned that as certified."""
    packing = {"layers": 4, "disks_per_row": 9}
    protocol = {"method": "path", "static_finish": False, "stop_kinetic_energy": 1e-6, "load_factors": [0.0, 0.1]}
    solution = solve_scene(Scene().updated({"packing": packing, "protocol": protocol}))
    residuals = [state.certificate.force_residual for state in solution.loaded]
    assert max(residuals) < 1e-9
    assert certify(solution.problem, solution.rest).force_residual > 1e-6


def test_a_result_without_statics_says_how_far_it_is_out_of_balance():
    """Where the static finish is asked for, and the law has none. It is not called unstable: nobody has looked."""
    asked = {"packing.layers": 3, "packing.disks_per_row": 5, "protocol.friction_law": "unloading"}
    with pytest.warns(UserWarning, match="not certified: up to .* out of balance .*friction_law unloading is a law of"):
        result = gr.solve(gr.Scene(loads=[gr.Load(disk="top-centre", force=(0, -3))]).updated(asked), progress=False)
    assert result.certificate.unbalanced_part > 1e-6 and "not in balance" in repr(result)


def test_stability_that_nobody_looked_at_is_said_so(tmp_path):
    solution = solve_scene(scene())
    (state,) = solution.loaded
    assert state.certificate.stable is True
    assert to_dataset(solution).attrs["stable"] == "yes"
    for modes, stable, said in ((None, None, "not determined"), (1, False, "no")):
        certificate = replace(state.certificate, negative_modes=modes)
        assert certificate.stable is stable
        other = replace(state, reached=replace(state.reached, certificate=certificate))
        data = to_dataset(replace(solution, loaded=(other,)))
        assert data.attrs["stable"] == said
        assert state_from(data).certificate == certificate
        store.write(tmp_path / "result.nc", data)
        lines = shown(tmp_path / "result.nc").splitlines()
        assert [line.split()[1:] for line in lines if line.startswith("stable")] == [said.split()]
        row = next(line for line in lines if line.startswith("unstable modes"))
        assert row.split(maxsplit=2)[2].split(maxsplit=1) == ["0", "not determined" if modes is None else "1"]
