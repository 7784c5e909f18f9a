"""What integrators say of themselves."""

import numpy as np
import pytest
from small_scenes import free_disks

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics


@pytest.mark.parametrize("name", INTEGRATORS)
def test_free_fall_is_exact(name):
    """Constant acceleration: position and velocity are right to rounding for every integrator."""
    problem, state = free_disks([[500.0, 400.0]], velocity=[(0.3, 2.0)], contact__friction=0.0)
    dynamics = Dynamics(problem, state, name, 2e-3)
    dynamics.advance(1000)
    assert dynamics.rebuilds > 2
    assert dynamics.time == pytest.approx(2.0)
    assert dynamics.position[0] == pytest.approx([500.6, 400.0 + 4.0 - 2.0], abs=1e-10)
    assert dynamics.v == pytest.approx([0.3, 2.0 - 2.0], abs=1e-11)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_free_spin_is_exact(name):
    problem, state = free_disks([[500.0, 400.0]], spin=[2.0], contact__friction=0.3)
    dynamics = Dynamics(problem, state, name, 1e-3)
    dynamics.advance(500)
    assert dynamics.angle == pytest.approx([1.0], abs=1e-12)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_same_bits_in_one_part_or_many(name):
    runs = []
    for parts in ([96], [8] * 12, [40, 56]):
        problem, state = free_disks([[10.0, 1.0], [11.0, 2.7]], contact__friction=0.5)
        dynamics = Dynamics(problem, state, name, 2e-4)
        for steps in parts:
            dynamics.advance(steps)
        runs.append(np.concatenate([dynamics.q, dynamics.v]))
    assert np.array_equal(runs[0], runs[1])
    assert np.array_equal(runs[0], runs[2])
