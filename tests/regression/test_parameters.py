"""What the parameters of a figure group must be: each mistake is named, with its place."""

from typing import Any

import pytest
import reduced

from granular_response.scene import SceneError
from granular_response_paper.registry import group_member

ROUGH = {"friction": 0.0, "floor": "rough"}
BETWEEN = {"friction": 0.2, "floor": "smooth", "gravity": "at-once", "disks_per_layer": 6, "layers": [4]}
SERIES = {"name": "one", "friction": 0.0, "layers": [5, 7]}
LOOP = {"polydispersity": 0.1, "friction": 0.2, "forces": [0.3, 1.0], "increments": 2}
WAY = {"name": "x", "changes": {}}
PICTURE = {"polydispersity": 0.3, "friction": 0.2, "force": 5.0, "realization": 0}
TAPS = {"number": 1, "amplitudes": [0.5], "durations": [3.0]}
MEANS, ENSEMBLE = reduced.parameters("polydisperse_averages"), {"polydispersities": [0.0], "friction": 0.0}
LOADED, SIZES = reduced.parameters("moduli")["loaded"], {"polydispersity": 0.1, "friction": 0.0, "layers": [5, 7]}

#: For each group: changes to its reduced section (None: left out), and what is said.
MISTAKES: dict[str, list[tuple[dict[str, Any], str]]] = {
    "crossover_scaling": [
        ({"series": [SERIES | {"layers": [6, 8]}]}, r"layers\[0\] = 6: must be odd"),
        ({"series": [SERIES, SERIES]}, "must have different names"),
    ],
    "friction_fields": [({"profiles": {"frictions": [0.5], "force": 12.0, "rows": [1.5]}}, r"profiles\.frictions = ")],
    "friction_linear_range": [({"frictions": [0.0, 0.3, 1.0]}, "frictions = .*: must have 0\\.2 and 1 among them")],
    "frictionless_crossover": [
        ({"scene": {"packing": {"layers": 0}}}, r"scene\.packing\.layers = 0: must be a whole number from 1"),
        ({"scene": {"contact": {"friction": 0.2}}}, r"scene\.contact\.friction = 0\.2: is decided by the group"),
        ({"scene": {"protocol": {"method": "path"}}}, r"scene\.protocol\.method = 'path': is decided by the group"),
        ({"scene": {"packing.layers": 3, "packing": {"layers": 4}}}, "'layers' is named twice"),
        ({"forces": [1.0, 0.5]}, r"forces = \[1\.0, 0\.5\]: must be growing numbers"),
        ({"scene": 1.0}, r"scene = 1\.0: must be a mapping with keys of a scene"),
        ({"forces": [1.0, -0.5]}, r"forces\[1\] = -0\.5: must be a number greater than 0"),
        ({"sizes": [[5, 6]]}, r"sizes\[0\]\[1\] = 6: must be a whole number from 7 on"),
        ({"tolerence": 0.1}, r"tolerence = 0\.1: unknown key, did you mean tolerance\?"),
        ({"sizes": [[5, 11], [6]]}, r"sizes\[1\]\[1\]: missing"),
    ],
    "hysteresis": [
        ({"cases": [LOOP, LOOP]}, "must have each material once"),
        ({"cases": []}, r"cases = \[\]: must have at least one entry"),
    ],
    "network": [
        ({"polydispersities": [0.0]}, r"polydispersities = \[0.0\]: must be above 0"),
        ({"scene": {"packing.layers": 5}}, r"scene\.packing\.layers = 5: must be more: contacts nearer than 4 radii"),
    ],
    "numerics": [
        ({"frictions": [0.2, 0.2]}, r"frictions = \[0\.2, 0\.2\]: must have each entry once"),
        ({"integrators": ["beeman"]}, r"integrators = .*: must have at least two entries, to compare"),
    ],
    "overview": [({"forces": [0.5]}, r"forces = \[0\.5\]: must have at least two entries")],
    "rolling_resistance": [
        ({"most_friction": 0.05}, r"most_friction = 0.05: must be above least_friction = 0.05"),
        ({"layers": [1]}, r"layers\[0\] = 1: must be a whole number from 2 on"),
    ],
    "experiments": [
        ({"packings": {}}, r"cases\[0\]\.packing = 'nearly equal': must be one of packings \(\)"),
        ({"pictures": [9]}, r"pictures = \[9\]: must be below 3"),
    ],
    "influence": [({"fitted": [6.0, 1.0]}, r"fitted = \[6.0, 1.0\]: must be two growing numbers")],
    "moduli": [
        ({"cases": [SIZES | {"realizations": [4]}]}, r"realizations = \[4\]: must have a number for each of the"),
        ({"loaded": LOADED | {"scene": {"packing.layers": 1}}}, r"loaded\.scene\.packing\.layers = 1: must be 2 or"),
    ],
    "pile_dip": [({"dip_height": -1.0}, r"dip_height = -1\.0: must be a number greater than 0")],
    "polydisperse_averages": [
        ({"cases": [ENSEMBLE | {"forces": [2.0]}]}, "must have a polydispersity above 0"),
        ({"cases": [ENSEMBLE | {"forces": [2.0, 1.0]}]}, r"cases\[0\].forces = .*: must be"),
        ({"forces_picture": PICTURE}, "forces_picture = .*: must be"),
        ({"individual": MEANS["individual"] | {"force": 7.0}}, "individual = "),
    ],
    "preparation": [
        ({"ways": [WAY | {"changes": {"contact.friction": 1.0}}]}, "must have keys among preparation.gravity"),
        ({"ways": [WAY, WAY]}, "must have different names"),
        ({"parts": [{"friction": 0.2, "ways": ["none"], "to": 4.0}]}, r"parts\[0\]\.ways = .*: must be among the"),
        ({"parts": [{"friction": 0.2, "to": 0.01}]}, "must not be below the first of forces"),
        ({"parts": [{"friction": 0.2, "to": 4.0, "taps": TAPS}]}, r"parts\[0\]\.taps = .*: must be left out"),
    ],
    "slab_comparison": [
        ({"cases": [{"friction": 0.2}]}, r"cases\[0\]\.floor: missing"),
        ({"cases": [BETWEEN | ROUGH]}, "floor = 'rough': must be smooth, or rough with friction above 0"),
        ({"cases": [BETWEEN | {"layers": [4.5]}]}, r"cases\[0\]\.layers\[0\] = 4\.5"),
    ],
    "stiffness_ratio_crossover": [({"ratios": [0.3, 0.2]}, "ratios = .*: must be")],
    "superposition": [
        ({"forces": [1.0, 0.5]}, r"forces = \[1.0, 0.5\]: must be growing numbers"),
        ({"forces": [0.2, 0.5]}, r"forces = \[0\.2, 0\.5\]: must have 0\.2 and 1 among them"),
        ({"offsets": [10]}, "must be places from 1 to 9"),
    ],
    "theory": [
        ({"stiffness_ratio": -0.1}, "stiffness_ratio = .*: must be"),
        ({"ray_angle": 90.0}, "ray_angle = .*: must be"),
        ({"points": 120}, "points = 120: must be odd"),
    ],
    "torque": [({"torques": [1.0, 2.0]}, "torques = .*: must be")],
}


@pytest.mark.parametrize(
    ("group", "change", "said"), [(group, *mistake) for group, mistakes in MISTAKES.items() for mistake in mistakes]
)
def test_a_mistake_in_the_parameters_of_a_group_is_named(group, change, said):
    given = {**reduced.parameters(group), **change}
    with pytest.raises(SceneError, match=said):
        group_member(group, "parameters", "Parameters")(**{k: v for k, v in given.items() if v is not None})
