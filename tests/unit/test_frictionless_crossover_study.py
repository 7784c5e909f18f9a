"""The study of Sec. IV: what it asks for, what it measures on a rest state, where its rest states come from."""

from dataclasses import replace

import numpy as np

from granular_response.solvers.problem import Problem
from granular_response_paper.groups.frictionless_crossover import simulate as study
from granular_response_paper.groups.frictionless_crossover.simulate.slab import (
    Slab,
    new_neighbours,
    settle,
)

PARAMETERS = {
    "method": "auto",
    "scene": {"packing": {"layers": 5, "disks_per_row": 11}},
    "forces": [0.5, 1],
    "tolerance": 0.01,
    "sizes": [[5, 11], [6, 12]],
    "widths": [[5, 11], [5, 15]],
    "size_stiffnesses": [3000.0, 1e5],
    "size_forces": [1.0, 2.0],
    "size_tolerance": 0.05,
    "region_layers": 5,
    "region_forces": [1.5],
    "stiffnesses": [1000.0, 3000.0, 1e5],
    "stiffness_forces": [0.75],
    "compared_stiffnesses": [1000.0, 1e5],
}

BASE = study.Parameters(**PARAMETERS).base


def test_each_slab_is_one_task_with_all_its_forces() -> None:
    tasks = {slab: task.args for slab, task in study.tasks(study.Parameters(**PARAMETERS)).items()}
    forces = {slab: given[1] for slab, given in tasks.items()}
    assert len(tasks) == 7
    assert forces[Slab(5, 11, 3000.0)] == (0.5, 0.75, 1.0, 1.5, 2.0)
    assert forces[Slab(5, 11, 1e5)] == (0.75, 1.0, 1.5, 2.0)
    assert forces[Slab(5, 11, 1000.0)] == (0.75,)
    assert forces[Slab(6, 12, 1e5)] == (1.0, 2.0)
    assert [slab for slab, (*_, keep_states) in tasks.items() if keep_states] == [Slab(5, 11, 3000.0)]
    assert tasks[Slab(5, 15, 3000.0)][2] == 0.05


def test_new_neighbours_are_touching_pairs_that_were_apart() -> None:
    problem = Problem.from_scene(Slab(3, 7, 3000.0).scene(BASE))
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
    soft, stiff = Slab(8, 24, 20.0), Slab(8, 24, 3000.0)
    packing = Problem.from_scene(soft.scene(BASE)).packing
    fallen, held = settle(soft.scene(BASE)), settle(stiff.scene(BASE))
    assert fallen.certificate.stable
    assert fallen.certificate.force_residual < 1e-9
    assert new_neighbours(packing.position, fallen) > 0
    assert held.reached.method == "minimise"
    assert new_neighbours(packing.position, held) == 0
