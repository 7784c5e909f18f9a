"""Figs. 3 to 5 on small slabs, from parameters through a file to figures."""

from dataclasses import replace

import numpy as np
import reduced

from granular_response.solvers.problem import Problem
from granular_response_paper.groups.frictionless_crossover import simulate as study
from granular_response_paper.groups.frictionless_crossover.simulate.slab import OrderedSlab, new_neighbours, settle

BASE = study.Parameters(**reduced.parameters("frictionless_crossover")).base


def test_new_neighbours_are_touching_pairs_that_were_apart() -> None:
    problem = Problem.from_scene(OrderedSlab(3, 7, 3000.0).scene(BASE))
    packing = problem.packing
    pushed = packing.position.copy()
    pushed[:, 0] *= 0.999
    state = problem.relisted(replace(problem.bare_state(), position=pushed))
    assert new_neighbours(packing.position, state) == 0
    # the first disk of the bottom row goes on top of the third
    pushed[0] = pushed[2] + (0.0, 1.9)
    moved = problem.relisted(replace(problem.bare_state(), position=pushed))
    touching = moved.pairs.touching & ((moved.pairs.first == 0) | (moved.pairs.second == 0))
    others = np.where(moved.pairs.first == 0, moved.pairs.second, moved.pairs.first)[touching]
    apart = np.linalg.norm(packing.position[others] - packing.position[0], axis=1) > 3.0
    assert apart.any()
    assert new_neighbours(packing.position, moved) == int(apart.sum())


def test_soft_disks_are_settled_by_dynamics() -> None:
    """Where the lattice does not hold, the rest state comes from the fall; elsewhere from the minimum."""
    soft, stiff = OrderedSlab(8, 24, 20.0), OrderedSlab(8, 24, 3000.0)
    packing = Problem.from_scene(soft.scene(BASE)).packing
    fallen, held = settle(soft.scene(BASE)), settle(stiff.scene(BASE))
    assert fallen.certificate.stable
    assert fallen.certificate.force_residual < 1e-9
    assert new_neighbours(packing.position, fallen) > 0
    assert held.reached.method == "minimise"
    assert new_neighbours(packing.position, held) == 0
