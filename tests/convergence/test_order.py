"""Order of each integrator. Settled states depend neither on the time step nor on it: the group ``numerics``."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import free_disks

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.solvers.dynamics import Dynamics

STIFFNESS = 6000.0
AMPLITUDE = 1e-5
STEPS = (2e-4, 1e-4, 5e-5)


def errors(integrator: str, damping_ratio: float, *, known_start: bool) -> np.ndarray:
    """Errors of the position after a time of 0.1 (1.2 swings), in amplitudes, for each time step.

    ``known_start`` gives a predictor-corrector the derivatives at the start that it would otherwise take as zero.
    """
    frequency = np.sqrt(STIFFNESS)
    rate = complex(-damping_ratio * frequency, frequency * np.sqrt(1.0 - damping_ratio**2))
    speed = AMPLITUDE * frequency

    def derivative(order: int, time: float) -> float:
        return float((speed / rate.imag * rate**order * np.exp(rate * time)).imag)

    found = []
    for step in STEPS:
        problem, state = free_disks(
            [[500.0, 1.0 - 1.0 / STIFFNESS]], contact__friction=0.0, wall__damping_ratio=damping_ratio
        )
        state = replace(state, velocity=np.array([[0.0, speed]]))
        dynamics = Dynamics(problem, state, integrator, step)
        if known_start and integrator == "gear":
            dynamics.history[1, 1], dynamics.history[2, 1] = derivative(3, 0.0), derivative(4, 0.0)
        dynamics.advance(round(0.1 / step))
        found.append(abs(dynamics.q[1] - derivative(0, 0.1)) / AMPLITUDE)
    return np.array(found)


@pytest.mark.parametrize("damping_ratio", [0.0, 0.2])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_order(integrator, damping_ratio):
    error = errors(integrator, damping_ratio, known_start=True)
    order = np.log2(error[:-1] / error[1:])
    expected = INTEGRATORS[integrator].order
    if integrator == "leapfrog" and damping_ratio == 0.0:
        expected = 2  # only dashpots see the velocity half a step earlier
    assert np.all(order > expected - 0.1)
    assert np.all(order < expected + 0.6)
    assert error[0] < (1e-4 if expected > 1 else 5e-3)


def test_gear_from_rest_is_of_second_order():
    """Starting with third and fourth derivatives of zero costs two orders, for good."""
    error = errors("gear", 0.0, known_start=False)
    assert np.log2(error[:-1] / error[1:]) == pytest.approx([2.0, 2.0], abs=0.05)
    assert np.all(error < errors("beeman", 0.0, known_start=True))
