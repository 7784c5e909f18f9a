"""Frictionless equilibria as minima of the energy."""

import numpy as np
import pytest
from small_scenes import free_disks, scene, started

from granular_response.errors import EquilibriumError
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.energy import energy, minimise
from granular_response.solvers.equilibrium import external_force, finish
from granular_response.solvers.problem import Problem


def test_one_disk_on_the_floor_by_hand():
    problem, state = free_disks([[500.0, 1.0]], contact__friction=0.0)
    assert minimise(problem, state).position[0, 1] == pytest.approx(1.0 - 1.0 / 6000.0, abs=1e-14)


def test_column_between_walls_by_hand():
    """Two disks on each other: 2 weights on the floor spring, 1 on the spring between them."""
    problem, state = free_disks([[1.0, 1.0], [1.0, 3.0]], width=2.0, contact__friction=0.0)
    z = minimise(problem, state).position[:, 1]
    assert z == pytest.approx([1.0 - 2.0 / 6000.0, 3.0 - 2.0 / 6000.0 - 1.0 / 3000.0], abs=1e-13)


def test_minimum_is_where_dynamics_ends():
    problem = Problem.from_scene(scene(contact__friction=0.0))
    found = minimise(problem, problem.bare_state())
    settled = finish(problem, relax(Dynamics(problem, problem.bare_state()), Stop(1e-14)))
    assert found.position == pytest.approx(settled.position, abs=1e-11)


def test_energy_is_lowest_there():
    problem = Problem.from_scene(scene(contact__friction=0.0))
    state = minimise(problem, problem.bare_state())
    system, known = started(problem, state)
    external = external_force(problem, 0.0)
    lowest = energy(system, system.trial(known, known.q), external)
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = known.q + rng.normal(0, 1e-3, system.dof)
        assert energy(system, system.trial(known, q), external) > lowest


def test_friction_has_no_energy_to_minimise():
    problem = Problem.from_scene(scene())
    with pytest.raises(ValueError, match="without friction"):
        minimise(problem, problem.bare_state())


def test_a_disk_that_falls_for_ever_is_an_error():
    problem, state = free_disks([[500.0, 1.0], [500.5, 1e5]], contact__friction=0.0)
    with pytest.raises(EquilibriumError):
        minimise(problem, state)
