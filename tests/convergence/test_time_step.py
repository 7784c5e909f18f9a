"""Settled states do not depend on the time step (claim N4) nor on the integrator (N5)."""

from functools import cache

import numpy as np
import pytest
from small_scenes import scene

from granular_response.observe.floor import floor_force
from granular_response.solvers.solution import solve_scene

FLOOR = np.arange(13)


@cache
def response(integrator: str, step: float):
    changes = {"protocol__method": "dynamics", "protocol__integrator": integrator, "protocol__time_step": step}
    solution = solve_scene(scene(6, 13, loads=[{"disk": "top-centre", "force": [0.0, -4.0]}], **changes))
    return (floor_force(solution.loaded[0], FLOOR) - floor_force(solution.rest, FLOOR)) / 4.0


@pytest.mark.parametrize(
    ("integrator", "step"),
    [("beeman", 2e-4), ("beeman", 1e-4), ("verlet", 4e-4), ("verlet", 2e-4), ("leapfrog", 2e-4), ("gear", 2e-4)],
)
def test_response_does_not_depend_on_step_and_integrator(integrator, step):
    assert np.abs(response("beeman", 4e-4)).max() > 0.15
    assert response(integrator, step) == pytest.approx(response("beeman", 4e-4), abs=1e-4, rel=0)
