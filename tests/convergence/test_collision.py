"""Collisions against closed forms, as the time step falls."""

import numpy as np
import pytest
from small_scenes import free_disks

from granular_response.solve import Dynamics


def rebound(damping_ratio: float, step: float, integrator: str = "beeman", wall: bool = False) -> float:
    """Speed after over speed before a head-on collision of two disks, or of a disk with the floor."""
    if wall:
        problem, state = free_disks(
            [[500.0, 1.01]], velocity=[(0.0, -1.0)], contact__friction=0.0, wall__damping_ratio=damping_ratio
        )
    else:
        problem, state = free_disks(
            [[500.0, 50.0], [502.01, 50.0]],
            velocity=[(0.5, 0.0), (-0.5, 0.0)],
            contact__friction=0.0,
            contact__damping_ratio=damping_ratio,
        )
    dynamics = Dynamics(problem, state, integrator, step)
    dynamics.set_ramps(gravity=(0.0, 0.0, 0.0))
    dynamics.advance(round(0.3 / step))
    assert not dynamics.touching().any()
    return float(dynamics.v[1]) if wall else float(dynamics.v[1] - dynamics.v[0])


def closed_form(ratio: float) -> float:
    """A contact ends with its overlap: exp(-pi zeta / sqrt(1 - zeta^2)), zeta of the reduced mass."""
    return float(np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2)))


@pytest.mark.parametrize("integrator", ["beeman", "verlet", "gear"])
def test_undamped_collision_keeps_its_energy(integrator):
    error = [abs(rebound(0.0, step, integrator) ** 2 - 1.0) for step in (4e-4, 1e-4)]
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


def test_slide_turns_into_rolling():
    """Deceleration mu g until v = 2/3 of the start, whatever the friction; then it rolls with no loss."""
    for friction in (0.05, 0.3):
        problem, state = free_disks(
            [[500.0, 1.0 - 1.0 / 6000.0]], velocity=[(0.3, 0.0)], contact__friction=0.0, wall__friction=friction
        )
        dynamics = Dynamics(problem, state, "beeman", 2e-4)
        dynamics.advance(1000)
        assert dynamics.v == pytest.approx([0.3 - friction * 0.2, 0.0, -2.0 * friction * 0.2], abs=1e-4)
        dynamics.advance(20_000)
        assert dynamics.v == pytest.approx([0.2, 0.0, -0.2], abs=1e-9)
        rolled = dynamics.position[0, 0] - dynamics.angle[0] * -1.0
        dynamics.advance(1000)
        assert dynamics.position[0, 0] + dynamics.angle[0] == pytest.approx(rolled, abs=1e-9)
