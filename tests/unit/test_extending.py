"""The recipes of docs/extending.md, followed with a law and an integrator that the package does not have."""

import numpy as np
import pytest
from demonstration import RECORD, problem

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics
from granular_response.solvers.energy import minimise
from granular_response.solvers.equilibrium import certify
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state
from granular_response.solvers.timestep import oscillator_limit


def test_a_law_of_ones_own_is_minimised():
    smooth = problem(0.0)
    rest = minimise(smooth, smooth.bare_state())
    assert certify(smooth, rest).force_residual < 1e-9
    normal, overlap = rest.pairs.normal_force, rest.pairs.overlap
    closed = overlap > 0
    assert normal[closed] == pytest.approx(1000.0**3 * overlap[closed] ** 3)


def test_a_law_of_ones_own_settles_and_follows_a_path():
    rough = problem(0.5)
    rest = rest_state(rough)
    assert rest.certificate.stable and rest.certificate.force_residual < 1e-9
    (loaded,) = follow(rough.with_loads(rest.position), rest, [0.1])
    assert loaded.certificate.force_residual < 1e-9
    added = loaded.walls.normal_force.sum() - rest.walls.normal_force.sum()
    assert added == pytest.approx(1.5, rel=0.3)  # the floor takes it up, the side walls give and take a little


def test_an_integrator_of_ones_own(monkeypatch):
    monkeypatch.setitem(INTEGRATORS, "euler", RECORD)
    made = Problem.from_scene(Scene().updated({"packing": {"layers": 3, "disks_per_row": 7}}))
    ours, paper = (Dynamics(made, made.bare_state(), name, 1e-5) for name in ("euler", "beeman"))
    for dynamics in (ours, paper):
        dynamics.set_ramps()
        dynamics.advance(2000)
    moved = np.abs(paper.position - made.packing.position).max()
    assert 0 < np.abs(ours.position - paper.position).max() < 0.01 * moved
    # an undamped spring: stable up to 2 over the frequency
    assert oscillator_limit("euler", 400.0, 0.0) == pytest.approx(0.1, rel=2e-2)
