"""What the parameters of a figure group must be: each mistake is named, with its place."""

from typing import Any

import pytest
import reduced

from granular_response.scene import SceneError
from granular_response_paper.registry import group_member

SERIES = {"name": "one", "friction": 0.0, "layers": [5, 7]}
ENSEMBLE = {"polydispersities": [0.0], "friction": 0.0}

#: For each group: changes to its reduced section, and what is said.
MISTAKES: dict[str, list[tuple[dict[str, Any], str]]] = {
    "crossover_scaling": [({"series": [SERIES | {"layers": [6, 8]}]}, r"layers\[0\] = 6: must be odd")],
    "frictionless_crossover": [
        ({"scene": {"packing": {"layers": 0}}}, r"scene\.packing\.layers = 0: must be a whole number from 1"),
        ({"scene": {"contact": {"friction": 0.2}}}, r"scene\.contact\.friction = 0\.2: is decided by the group"),
        ({"scene": {"protocol": {"method": "path"}}}, r"scene\.protocol\.method = 'path': is decided by the group"),
        ({"scene": {"packing.layers": 3, "packing": {"layers": 4}}}, "'layers' is named twice"),
        ({"scene": 1.0}, r"scene = 1\.0: must be a mapping with keys of a scene"),
        ({"forces": [1.0, 0.5]}, r"forces = \[1\.0, 0\.5\]: must be growing numbers"),
        ({"forces": [1.0, -0.5]}, r"forces\[1\] = -0\.5: must be a number greater than 0"),
        ({"tolerence": 0.1}, r"tolerence = 0\.1: unknown key, did you mean tolerance\?"),
        ({"sizes": [[5, 11], [6]]}, r"sizes\[1\]\[1\]: missing"),
    ],
    "hysteresis": [({"cases": []}, r"cases = \[\]: .* at least 1 item")],
    "numerics": [({"frictions": [0.2, 0.2]}, r"frictions = \[0\.2, 0\.2\]: must have each entry once")],
    "overview": [({"forces": [0.5]}, r"forces = \[0\.5\]: .* at least 2 items")],
    "rolling_resistance": [({"layers": [1]}, r"layers\[0\] = 1: must be a whole number from 2 on")],
    "pile_dip": [({"dip_height": -1.0}, r"dip_height = -1\.0: must be a number greater than 0")],
    "polydisperse_averages": [({"cases": [ENSEMBLE | {"forces": [2.0, 1.0]}]}, r"cases\[0\].forces = .*: must be")],
    "slab_comparison": [({"cases": [{"friction": 0.2}]}, r"cases\[0\]\.floor: missing")],
    "theory": [
        ({"ray_angle": 90.0}, "ray_angle = .*: must be less than 90"),
        ({"points": 4}, "points = 4: must be odd"),
    ],
    "torque": [({"torques": [1.0, 2.0]}, r"torques = \[1\.0, 2\.0\]: must begin with 0")],
}


@pytest.mark.parametrize(
    ("group", "change", "said"), [(group, *mistake) for group, mistakes in MISTAKES.items() for mistake in mistakes]
)
def test_a_mistake_in_the_parameters_of_a_group_is_named(group, change, said):
    with pytest.raises(SceneError, match=said):
        group_member(group, "parameters", "Parameters")(**{**reduced.parameters(group), **change})
