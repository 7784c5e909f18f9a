"""Minima of the energy of packings without friction."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import scene

from granular_response.observe.network import mirror_disks
from granular_response.scene import Scene
from granular_response.solvers import energy
from granular_response.solvers.energy import minimise
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state


def test_a_slab_is_minimised_from_its_lattice_however_large_it_counts(monkeypatch):
    """With the settings of large packings, of which the search begins little damped, the same minimum."""
    problem = Problem.from_scene(scene(12, 49, contact__friction=0.0, contact__normal_stiffness=28800.0))
    alone = rest_state(problem)
    monkeypatch.setattr(energy, "OPTIONS", replace(energy.OPTIONS, large=300))
    found = rest_state(problem)
    assert found.position == pytest.approx(alone.position, abs=1e-9)
    assert found.certificate.stable and found.certificate.force_residual < 1e-10


@pytest.mark.parametrize("large", [10_000, 0])
def test_a_saddle_is_left_for_a_minimum(monkeypatch, large):
    """Half-way between the heap's minimum and its mirror image there is a symmetric saddle."""
    problem = Problem.from_scene(Scene.from_dict({"packing": {"kind": "pile"}, "contact": {"friction": 0.0}}))
    rest = rest_state(problem)
    mirror = mirror_disks(problem.packing.position, 0.5 * problem.packing.width)
    reflected = rest.position[mirror] * [-1.0, 1.0] + [problem.packing.width, 0.0]
    half_way = problem.with_static_forces(replace(rest, position=0.5 * (rest.position + reflected)))
    monkeypatch.setattr(energy, "OPTIONS", replace(energy.OPTIONS, large=large))
    found = minimise(problem, half_way)
    assert large or found.reached.escapes == 1
    assert found.certificate.negative_modes == 0
    assert found.certificate.force_residual < 1e-9
    assert min(np.abs(found.position - rest.position).max(), np.abs(found.position - reflected).max()) < 1e-8
