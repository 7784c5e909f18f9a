"""Preparations of a slab of 5 layers of 13 disks: when a growing force does what, and the figure of it."""

import numpy as np
import pytest
import reduced

from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.solvers.taps import tapped as after_taps
from granular_response.solvers.timestep import resolve_time_step
from granular_response.state import State
from granular_response_extensions.preparation.parameters import Parameters

PARAMETERS = reduced.parameters("preparation")


def test_mobilized_contacts_of_every_slab_stand_beside_its_events(datasets):
    mobilized, events = datasets["mobilized"], datasets["events"]
    tapped = mobilized["taps"].values > 0
    np.testing.assert_array_equal(mobilized["way"][tapped], ["slow", "slow"])
    np.testing.assert_array_equal(mobilized["tap_amplitude"][tapped], [0.5, 2.0])
    mobilized = mobilized.isel(case=~tapped)
    ordered = mobilized.isel(case=mobilized["polydispersity"].values == 0.0)
    part = ordered["mobilized_part"].values
    assert (part[:, 0] <= part[:, 1]).all() and part[2, 0] > 0.0 == part[3, 0]
    for name in ordered["name"].values:
        known = events["high"].values[events["name"].values == name]
        np.testing.assert_array_equal(ordered["force"].sel(name=name), known)
    disordered = mobilized.isel(case=mobilized["polydispersity"].values > 0.0)
    assert disordered["realization"].values.tolist() == [0, 1]
    assert np.isnan(disordered["force"].sel(name="crossover")).all()
    assert (disordered["force"].sel(name="linear_range") > 0.0).all()


def tapped(friction: float, amplitude: float, parts: int = 1) -> tuple[State, State]:
    """The small slab at rest and after a tap, with the usual time step divided by ``parts``."""
    scene = Parameters(**PARAMETERS).base.updated({"contact.friction": friction, "wall.friction": 0.0})
    usual = resolve_time_step(Problem.from_scene(scene))
    problem = Problem.from_scene(scene.updated({"protocol.time_step": usual / parts}))
    rest = rest_state(problem)
    return rest, after_taps(problem, rest, 1, amplitude, 3.0)


@pytest.mark.parametrize("amplitude", [0.5, 2.0])
def test_a_tapped_slab_without_friction_comes_back_to_the_minimum_of_its_energy(amplitude):
    rest, after = tapped(0.0, amplitude)
    assert after.reached.steps > 0
    np.testing.assert_allclose(after.walls.normal_force, rest.walls.normal_force, atol=1e-10)


def test_a_tapped_slab_with_friction_is_the_same_with_half_the_time_step():
    rest, after = tapped(0.2, 0.5)
    force = after.walls.normal_force
    assert np.abs(force - rest.walls.normal_force).max() > 0.1
    np.testing.assert_allclose(tapped(0.2, 0.5, parts=2)[1].walls.normal_force, force, atol=1e-3)
