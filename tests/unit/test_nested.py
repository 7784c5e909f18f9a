"""Starts near the rest states of large slabs."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import scene

from granular_response.observe.network import mirror_disks
from granular_response.scene import Scene
from granular_response.solvers import energy, nested
from granular_response.solvers.energy import minimise
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state


def slab(layers, disks_per_row, **changes) -> Problem:
    changes = {"contact__friction": 0.0, "contact__normal_stiffness": 200.0 * layers**2, **changes}
    return Problem.from_scene(scene(layers, disks_per_row, **changes))


def test_a_field_that_vanishes_at_the_side_walls_is_carried_over_to_second_order():
    errors = []
    for rows in (8, 16):
        coarse, fine = slab(rows, 4 * rows + 1).packing, slab(2 * rows, 8 * rows + 1).packing

        def field(packing):
            x, z = packing.position.T
            across = np.sin(2.0 * np.pi * x / packing.width) * (1.0 + z / len(packing.row_count))
            return np.stack([across, 0.0 * x], axis=1)

        errors.append(np.abs(nested.prolonged(field(coarse), coarse, fine) - field(fine)).max())
    assert errors[1] < 0.3 * errors[0]


def test_the_same_minimum_in_fewer_iterations(monkeypatch):
    problem = slab(24, 97)
    alone = minimise(problem, problem.bare_state())
    monkeypatch.setattr(nested, "OPTIONS", replace(nested.OPTIONS, large=300))
    found = rest_state(problem)
    assert found.position == pytest.approx(alone.position, abs=1e-9)
    assert found.reached.newton_iterations < 0.7 * alone.reached.newton_iterations
    assert found.certificate.force_residual < 1e-10


@pytest.mark.parametrize(
    "changes",
    [
        {},  # too small
        {"packing__polydispersity": 0.1},
        {"packing__lattice_constant": 2.01},
        {"packing__kind": "pile"},
    ],
)
def test_other_packings_start_as_built(monkeypatch, changes):
    monkeypatch.setattr(nested, "OPTIONS", replace(nested.OPTIONS, large=20 if changes else 10_000))
    if changes.get("packing__kind") == "pile":
        problem = Problem.from_scene(Scene.from_dict({"packing": {"kind": "pile"}, "contact": {"friction": 0.0}}))
    else:
        problem = slab(8, 33, **changes)
    assert np.array_equal(nested.rest_start(problem).position, problem.packing.position)


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
