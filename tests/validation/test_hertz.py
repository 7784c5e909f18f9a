"""The 3/2 law in every way to an equilibrium."""

import numpy as np
import pytest
from small_scenes import pushed, scene

from granular_response.observe.floor import floor_force
from granular_response.solvers.solution import Solution, solve_scene

FLOOR = np.arange(9)


def solved(friction: float, method: str, factors=(1.0,)) -> Solution:
    # pressed together along x: without friction there is one equilibrium then
    hertz = {"contact__law": "hertz", "contact__friction": friction, "packing__lattice_constant": 1.999}
    return solve_scene(scene(5, 9, **hertz, loads=pushed(0.0, -1.0), protocol__method=method), load_factors=factors)


def by_hand(solution: Solution) -> None:
    """Every normal force is K sqrt(R) xi^(3/2) of the positions, and each disk is in equilibrium."""
    for state in (solution.rest, *solution.loaded):
        certificate = state.reached.certificate
        assert certificate.force_residual < 1e-9 and certificate.coulomb_excess < 1e-9
        assert certificate.negative_modes == 0 and certificate.smallest_normal_force > 0
        first, second = state.pairs.first, state.pairs.second
        xi = 2.0 - np.hypot(*(state.position[first] - state.position[second]).T)
        force = 2000.0**1.5 * np.maximum(xi, 0.0) ** 1.5
        assert state.pairs.normal_force == pytest.approx(force, abs=1e-9)
        floor = 4000.0**1.5 * np.maximum(1.0 - state.position[:9, 1], 0.0) ** 1.5
        assert floor_force(state, FLOOR) == pytest.approx(floor, abs=1e-9)
    n = solution.problem.n
    loaded = n + solution.load_factors[-1] * solution.total_force
    assert floor_force(solution.rest, FLOOR).sum() == pytest.approx(n, abs=1e-8)
    assert floor_force(solution.loaded[-1], FLOOR).sum() == pytest.approx(loaded, abs=1e-8)


@pytest.mark.parametrize(("friction", "limit"), [(0.0, 1e-9), (0.4, 2e-3)])
def test_every_method_finds_the_same_equilibrium(friction, limit):
    """With friction the path is the limit of a slow ramp."""
    methods = ("dynamics", "path", "auto")
    solutions = [solved(friction, method) for method in methods]
    for solution in solutions:
        by_hand(solution)
        floor = floor_force(solution.loaded[-1], FLOOR)
        assert floor == pytest.approx(floor_force(solutions[0].loaded[-1], FLOOR), abs=limit)
    if not friction:
        assert solutions[-1].loaded[-1].reached.method == "minimise"
