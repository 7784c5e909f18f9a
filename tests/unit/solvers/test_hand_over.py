"""From motion to statics: what is still moving when statics takes over leaves nothing behind in the equilibrium."""

import numpy as np
import pytest
from printed import shown
from refusals import refuses
from small_scenes import free_disks, scene, started

import granular_response as gr
from granular_response.api import result as results
from granular_response.errors import EquilibriumError
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers import choice, settle, timestep
from granular_response.solvers.dynamics import OPTIONS, Dynamics, Stop, half_swing, relax
from granular_response.solvers.equilibrium import OPTIONS as STATICS
from granular_response.solvers.equilibrium import external_force, newton
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import _statics, in_step
from granular_response.solvers.solution import rest_state
from granular_response.solvers.timestep import expected_fall, long_fall, resolve_time_step, stability_limit
from granular_response.state import State


def rough(layers=6, disks_per_row=13, **changes) -> Problem:
    return Problem.from_scene(
        scene(layers, disks_per_row, **({"contact__friction": 0.5, "wall__friction": 0.5} | changes))
    )


def apart(one: State, other: State) -> float:
    """Largest difference of a force on floor or side walls."""
    assert np.array_equal(one.walls.first, other.walls.first)
    return float(np.abs(one.wall_force() - other.wall_force()).max())


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_statics_finds_the_equilibrium_that_the_motion_ends_in(integrator, monkeypatch):
    """Springs follow velocities half a step ahead of displacements: left out, that stays in them for ever."""
    problem = rough(protocol__integrator=integrator)
    motion = Dynamics(problem, problem.bare_state(), integrator, resolve_time_step(problem))
    early, late = relax(motion, Stop(1e-20, acceleration=1e-4)), relax(motion, Stop(1e-20))
    end = _statics(problem, late, integrator)
    error = apart(_statics(problem, early, integrator), end)
    assert error < 1e-8
    monkeypatch.setattr(settle, "lead", lambda scheme: 0.0)
    uncorrected = apart(_statics(problem, early, integrator), end)
    assert uncorrected == error if integrator == "leapfrog" else uncorrected > 10.0 * error


#: Force (mg) on floor or walls that the end of a fall may be off.
MOST_LEFT = 1e-5
ROLLS = {"contact__rolling_friction": 0.1, "contact__rolling_stiffness_ratio": 0.5}


@pytest.mark.parametrize(
    ("friction", "walls", "more"),
    [(0.05, 0.0, {}), (0.5, 0.0, {}), (0.05, 0.2, {}), (0.5, 0.2, {}), (0.5, 0.2, ROLLS),
     (0.2, 0.0, {"packing__polydispersity": 0.05})],
)  # fmt: skip
def test_a_fall_ends_where_accelerations_are_small_in_the_equilibrium_of_its_end(friction, walls, more, monkeypatch):
    """And thirty times earlier it would not."""
    described = {"contact__friction": friction, "wall__friction": walls, **more}
    quick, paper = rest_state(rough(**described)), rough(**described, protocol__stop_kinetic_energy=1e-21)
    assert paper.plan.stop_acceleration == 0.0
    slow = rest_state(paper)
    assert quick.reached.steps < 0.8 * slow.reached.steps
    error = apart(quick, slow)
    assert error < MOST_LEFT
    for name in "AT_REST", "DISORDERED_AT_REST":
        monkeypatch.setattr(choice, name, 30.0 * getattr(choice, name))
    assert apart(rest_state(rough(**described)), slow) > 10.0 * error


def test_accelerations_are_watched_for_half_a_period_of_the_slowest_motion():
    problem = rough(12, 25)
    motion = Dynamics(problem, problem.bare_state())
    sizes = []
    relax(motion, Stop(1e-30, acceleration=1e-3), progress=lambda *_: sizes.append(motion.mean_acceleration()))
    small = len(sizes) - 1 - max(k for k, size in enumerate(sizes) if size >= 1e-3)
    assert small * 100 * motion.time_step >= 0.5 * problem.swing_time
    assert small == half_swing(problem, motion.time_step) > OPTIONS.readings


def test_a_packing_is_not_at_rest_while_one_of_its_disks_falls():
    """One of many changes their mean but little, and while it touches the floor it is not in flight."""
    stack = [[1.0 + 2.0 * k, 1.0 - 1 / 6000] for k in range(40)]
    problem, state = free_disks([*stack, [90.0, 1.5]], contact__friction=0.2)
    motion = Dynamics(problem, state)
    motion.set_ramps()
    assert motion.unrest(motion.contact_count()) == np.inf
    settled = relax(motion, Stop(1e-30, acceleration=1e-3))
    assert settled.position[-1, 1] == pytest.approx(1.0 - 1 / 6000, abs=1e-6)


def test_the_protocol_is_taken_at_its_word():
    """A stopping energy or rule that is given, ``method: dynamics``, or no static finish."""
    still = {"packing__polydispersity": choice.DISORDERED_AT_REST, "protocol__time_step": choice.AT_REST}
    for usual in ({}, {"packing__polydispersity": 0.1}, {"protocol__time_step": 1e-4}):
        plan = rough(**usual).plan
        expected = next((still[key] for key in usual), choice.AT_REST)
        assert (plan.stop_energy, plan.stop_acceleration, plan.larger_steps) == (1e-13, expected, False)
    for other in (
        {"protocol__stop_kinetic_energy": 1e-9},
        {"protocol__method": "dynamics"},
        {"protocol__stop_rule": "envelope"},
        {"protocol__static_finish": False},
    ):
        for order in ({}, {"packing__polydispersity": 0.1}):
            problem = rough(**other, **order)
            assert problem.plan.stop_acceleration == 0.0
            assert problem.plan.stop_energy == problem.scene.protocol.stop_kinetic_energy
    smooth = {"contact__friction": 0.0, "wall__friction": 0.0}
    assert rough(**smooth).plan.stop_energy == 1e-6 and rough(**smooth).plan.stop_acceleration == 0.0


def test_a_large_packing_goes_on_with_larger_steps(monkeypatch, tmp_path):
    """In fewer steps, to the same network; the result says both steps, and what error they leave."""
    smooth_walls = {"wall__friction": 0.0}
    usual = rest_state(rough(10, 21, **smooth_walls))
    for module in (choice, timestep, results):
        monkeypatch.setattr(module, "LARGE", 100)
    walled, problem = rough(10, 21), rough(10, 21, **smooth_walls)
    assert walled.plan.larger_steps and walled.plan.stop_acceleration == choice.AT_REST
    assert problem.plan.larger_steps and problem.plan.stop_acceleration == choice.NEARLY_AT_REST
    for given in (
        {"protocol__time_step": 5e-4},
        {"protocol__integrator": "leapfrog"},
        {"protocol__method": "dynamics"},
    ):
        assert not rough(10, 21, **given).plan.larger_steps
    result = gr.solve(problem.scene.updated({"loads": []}), progress=False)
    reached = result.rest.reached
    assert reached.first_time_step == 5e-4 < reached.time_step <= 0.9 * stability_limit(problem, "leapfrog")
    periods = timestep.FIRST_PERIODS * timestep.breathing_time(problem)
    assert reached.first_steps * 5e-4 >= max(periods, problem.swing_time)
    assert reached.first_steps < reached.steps < 0.9 * usual.reached.steps
    assert np.array_equal(result.rest.pairs.touching, usual.pairs.touching)
    assert apart(result.rest, usual) < 5e-3
    said = f"0.0005 for {reached.first_steps} steps, then leapfrog with {reached.time_step:.4g} for "
    assert said in repr(result) and "leaves an error of about" in repr(result)
    result.save(tmp_path / "slab.nc")
    again = gr.open_result(tmp_path / "slab.nc")
    assert again.rest.reached == reached and repr(again) == repr(result)
    assert said in " ".join(shown(tmp_path / "slab.nc").split())


def test_a_fall_that_takes_minutes_is_said_before():
    """Of the slabs of the benchmark the steps are known."""
    for layers, disks_per_row, steps in ((30, 121, 37_700), (60, 241, 110_400)):
        assert expected_fall(rough(layers, disks_per_row, wall__friction=0.0))[0] == pytest.approx(steps, rel=0.3)
    assert long_fall(rough()) == ""
    assert "min (preparation.gravity: frictionless" in long_fall(rough(160, 641))


def test_progress_of_a_swinging_packing_is_not_complete_before_it_rests():
    """Its mean acceleration passes zero twice in each period of the breathing, long before the end."""
    seen: list[float] = []
    problem = rough(4, 9, contact__friction=0.2, wall__friction=0.0)
    rest_state(problem, progress=lambda done, total, what: seen.append(done / total))
    assert len(seen) > 40 and seen == sorted(seen)
    assert np.flatnonzero(np.array(seen) > 0.99)[0] > 0.9 * len(seen)


def test_a_try_that_goes_round_in_a_circle_with_whole_steps_backtracks(monkeypatch):
    """A fall of a slab of 205 disks half-way: without, thirty iterations lead nowhere."""
    problem = Problem.from_scene(scene(10, 21, contact__friction=0.2))
    motion = Dynamics(problem, problem.bare_state())
    motion.set_ramps()
    motion.advance(6500)
    start = problem.with_static_forces(in_step(motion.state(), "beeman"))
    system, known = started(problem, start)
    external = external_force(problem, 0.0)
    assert not newton(system, known, external)[1].converged
    found = newton(system, known, external, maximum_iterations=STATICS.tries, backtracking=True)[1]
    assert found.converged and found.iterations == 8 > STATICS.whole_steps
    assert _statics(problem, motion.state(), "beeman").certificate.stable
    monkeypatch.setattr(type(problem.packing), "ordered", False)
    refuses(EquilibriumError, f"within {STATICS.tries} Newton iterations", _statics, problem, motion.state(), "beeman")
