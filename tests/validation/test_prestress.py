"""Gravity presses on the horizontal contacts of deep slabs of soft disks (docs/reproduction-notes.md)."""

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import rest_state


def horizontal_force(layers: int, stiffness: float) -> float:
    """Mean force of the horizontal contacts near the top and the middle, at rest without friction."""
    scene = Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": layers, "disks_per_row": 4 * layers},
            "contact": {"friction": 0.0, "normal_stiffness": stiffness},
            "wall": {"normal_stiffness": 2.0 * stiffness},
            "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
        }
    )
    rest = rest_state(Problem.from_scene(scene))
    ends = np.stack([rest.position[rest.pairs.first], rest.position[rest.pairs.second]])
    flat = np.abs(ends[0, :, 1] - ends[1, :, 1]) < 0.5
    middle = np.abs(ends[:, :, 0].mean(axis=0) - 4.0 * layers) < 8.0
    high = ends[:, :, 1].mean(axis=0) > rest.position[:, 1].max() - 6.0
    return float(rest.pairs.normal_force[flat & middle & high].mean())


def test_horizontal_contacts_of_soft_deep_slabs_are_pressed_together() -> None:
    stiff = [horizontal_force(layers, 1e5) for layers in (10, 20)]
    assert stiff[1] == pytest.approx(stiff[0], rel=0.1)
    assert horizontal_force(20, 3e3) == pytest.approx(stiff[1], rel=0.1)
    soft = [horizontal_force(20, stiffness) for stiffness in (1e3, 5e2)]
    assert soft[1] > 2.0 * stiff[1] and soft[0] > 1.2 * stiff[1]
