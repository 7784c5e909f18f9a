"""Collisions against closed forms, as the time step falls."""

import math

import numpy as np
import pytest
from small_scenes import free_disks

from granular_response.contact import LAWS
from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics


def head_on(
    damping_ratio: float, step: float, integrator: str = "beeman", wall: bool = False, law: str = "linear"
) -> Dynamics:
    """Two disks on their way to each other, or a disk to the floor, 0.01 apart with a relative speed of 1."""
    places, velocity = [[500.0, 50.0], [502.01, 50.0]], [(0.5, 0.0), (-0.5, 0.0)]
    if wall:
        places, velocity = [[500.0, 1.01]], [(0.0, -1.0)]
    damping = {"wall__damping_ratio" if wall else "contact__damping_ratio": damping_ratio}
    problem, state = free_disks(places, velocity=velocity, contact__friction=0.0, contact__law=law, **damping)
    dynamics = Dynamics(problem, state, integrator, step)
    dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
    return dynamics


def rebound(
    damping_ratio: float, step: float, integrator: str = "beeman", wall: bool = False, law: str = "linear"
) -> float:
    """Speed after over speed before a head-on collision of two disks, or of a disk with the floor."""
    dynamics = head_on(damping_ratio, step, integrator, wall, law)
    dynamics.advance(round(0.3 / step))
    assert not dynamics.touching().any()
    return float(dynamics.v[1]) if wall else float(dynamics.v[1] - dynamics.v[0])


def closed_form(ratio: float) -> float:
    """A contact ends with its overlap: exp(-pi zeta / sqrt(1 - zeta^2)), zeta of the reduced mass."""
    return float(np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2)))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("wall", [False, True], ids=["pair", "floor"])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_undamped_collision_keeps_its_energy(integrator, wall, law):
    error = [abs(rebound(0.0, step, integrator, wall, law) ** 2 - 1.0) for step in (4e-4, 1e-4)]
    assert error[0] < 2e-3
    assert error[1] < 2e-4


@pytest.mark.parametrize("wall", [False, True], ids=["pair", "floor"])
def test_overlap_and_duration_of_a_collision_by_the_power_three_halves(wall):
    """Reduced mass m, force kappa xi^(3/2), speed v: m v^2 / 2 is 2/5 kappa xi^(5/2) at the largest overlap.

    The time to it is the integral of ``d xi / sqrt(v^2 - 4 kappa xi^(5/2) / (5 m))``, a beta function.
    """
    mass, stiffness = (1.0, 6000.0) if wall else (0.5, 3000.0)
    kappa = (2.0 * stiffness / 3.0) ** 1.5
    largest = (5.0 * mass / (4.0 * kappa)) ** 0.4
    duration = 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * largest
    # the integral, with u = 1 - s^2 for the part of the largest overlap: nothing is singular then
    s = (np.arange(20_000) + 0.5) / 20_000
    assert 2.0 * largest * np.mean(2.0 * s / np.sqrt(1.0 - (1.0 - s**2) ** 2.5)) == pytest.approx(duration, rel=1e-8)
    step = 5e-6
    dynamics = head_on(0.0, step, "verlet", wall, "hertz")
    dynamics.advance(round(0.009 / step))  # they touch at 0.01
    overlaps = []
    while dynamics.time < 0.011 + duration:
        dynamics.advance(1)
        overlaps.append(1.0 - dynamics.position[0, 1] if wall else 2.0 - np.diff(dynamics.position[:, 0])[0])
    overlaps = np.array(overlaps)
    assert (overlaps > 0).sum() * step == pytest.approx(duration, abs=2.0 * step)
    assert overlaps.max() == pytest.approx(largest, rel=1e-5)
    assert not dynamics.touching().any()


@pytest.mark.parametrize("damping_ratio", [0.1, 0.5])
@pytest.mark.parametrize("wall", [False, True], ids=["pair", "floor"])
def test_restitution(damping_ratio, wall):
    """Two disks have a reduced mass of 1/2 and so sqrt(2) times the damping ratio; the floor has the ratio itself."""
    expected = closed_form(damping_ratio if wall else np.sqrt(2.0) * damping_ratio)
    error = [abs(rebound(damping_ratio, step, wall=wall) - expected) for step in (4e-4, 1e-4, 2.5e-5)]
    # the moment of touch falls anywhere within a step, so single errors jump about below a bound of first order
    assert error[0] < 8e-3
    assert error[1] < 2e-3
    assert error[2] < 5e-4
