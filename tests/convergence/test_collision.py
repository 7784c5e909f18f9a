"""Collisions against closed forms, as the time step falls."""

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
