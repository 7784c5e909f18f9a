"""From motion to statics: what is still moving when statics takes over leaves nothing behind in the equilibrium."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks, scene

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.kernels.integrators.stepping import Integrator
from granular_response.solvers import choice
from granular_response.solvers.dynamics import Dynamics, Relaxation, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.settle import _statics
from granular_response.solvers.solution import rest_state
from granular_response.solvers.timestep import resolve_time_step
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
    early, late = relax(motion, Stop(1e-20, quiet_energy=1e-9)), relax(motion, Stop(1e-20))
    end = _statics(problem, late)
    error = apart(_statics(problem, early), end)
    assert error < 1e-8
    monkeypatch.setattr(Integrator, "lead", 0.0)
    uncorrected = apart(_statics(problem, early), end)
    assert uncorrected == error if integrator == "leapfrog" else uncorrected > 10.0 * error


ROLLS = {"contact__rolling_friction": 0.1, "contact__rolling_stiffness_ratio": 0.5}


@pytest.mark.parametrize(
    ("friction", "walls", "rolling"),
    [(0.05, 0.0, {}), (0.5, 0.0, {}), (0.05, 0.2, {}), (0.5, 0.2, {}), (0.5, 0.2, ROLLS)],
)
def test_a_vibration_that_changes_no_contact_ends_in_the_same_equilibrium_sooner(friction, walls, rolling):
    described = {"contact__friction": friction, "wall__friction": walls, **rolling}
    quick, paper = rest_state(rough(**described)), rough(**described, protocol__stop_kinetic_energy=1e-21)
    assert paper.plan.quiet_energy < 1e-16
    slow = rest_state(paper)
    assert quick.reached.steps < 0.7 * slow.reached.steps
    assert apart(quick, slow) < 1e-8


def test_contacts_are_watched_for_a_whole_period_of_the_slowest_motion():
    """One that opens, closes or slides within it keeps the packing from being handed over."""
    problem = rough()
    motion = Dynamics(problem, problem.bare_state())
    run = Relaxation(motion, Stop(1e-30, quiet_energy=1e-9))
    changed = 0
    while not run.ended:
        motion.advance(100)
        before, touching, slid = run.network, motion.touching(), motion.slides()
        run.look()
        if before is None or (before != touching).any() or slid:
            changed = motion.steps
    assert changed > 0 and motion.kinetic_energy() < 1e-9
    assert (motion.steps - changed) * motion.time_step >= problem.swing_time


@pytest.mark.parametrize(("friction", "slides"), [(0.01, True), (0.9, False)])
def test_a_disk_that_slides_is_seen_and_nothing_changes_by_it(friction, slides):
    """And not one that rolls."""
    problem, state = free_disks(
        [[500.0, 1.0 - 1 / 6000]], velocity=[(0.01, 0.0)], contact__friction=0.5, wall__friction=friction
    )
    motion = Dynamics(problem, replace(state, angular_velocity=np.array([-0.01 if friction == 0.9 else 0.0])))
    motion.advance(50)
    kept = {name: getattr(motion, name).copy() for name in ("q", "v", "history", "spring", "wall_spring")}
    assert motion.slides() is slides
    for name, value in kept.items():
        assert np.array_equal(getattr(motion, name), value), name


@pytest.mark.parametrize(("limit", "slides"), [(0.001, True), (0.5, False)])
def test_a_disk_that_rolls_against_its_limit_is_seen(limit, slides):
    problem, state = free_disks(
        [[500.0, 1.0 - 1 / 6000]], velocity=[(0.01, 0.0)], contact__friction=0.5, wall__friction=0.9,
        wall__rolling_friction=limit, wall__rolling_stiffness_ratio=0.1,
    )  # fmt: skip
    motion = Dynamics(problem, replace(state, angular_velocity=np.array([-0.01])))
    motion.advance(50)
    spring = motion.wall_rolls.spring.copy()
    assert spring.all() and motion.slides() is slides
    assert np.array_equal(motion.wall_rolls.spring, spring)


def test_where_it_does_not_count():
    """Disordered packings change some contact nearly always; with ``method: dynamics`` the protocol is the paper's."""
    for stop, quiet in ((1e-15, choice.QUIET * 1e-15), (1e-13, 1e-9), (1e-12, choice.LARGEST_QUIET)):
        assert rough(protocol__stop_kinetic_energy=stop).plan.quiet_energy == pytest.approx(quiet)
    for other in (
        {"packing__polydispersity": 0.1},
        {"protocol__method": "dynamics"},
        {"protocol__stop_rule": "envelope"},
        {"protocol__static_finish": False},
        {"contact__friction": 0.0, "wall__friction": 0.0},
    ):
        assert rough(**other).plan.quiet_energy == 0.0
