"""Numbers of small scenes as they are now: a change that moves them is meant, or a mistake.

``pytest --force-regen`` stores new ones.
"""

import numpy as np
import pytest
from small_scenes import scene

from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.store.result import to_dataset

DOWN = [{"disk": "top-centre", "force": [0.0, -3.0]}]
#: Not symmetric: rounding decides to which side a symmetric one gives way.
PILE = {"kind": "pile", "layers": 5, "polydispersity": 0.01}
SCENES = {
    "frictionless": scene(5, 9, contact__friction=0.0, loads=DOWN),
    "frictional": scene(5, 9, loads=DOWN),
    "frictional_walls": scene(5, 9, wall__friction=0.3, loads=DOWN),
    "dynamics": scene(5, 9, loads=DOWN, protocol__method="dynamics"),
    "torque": scene(5, 9, contact__friction=0.5, loads=[{"disk": "top-centre", "force": [0.3, -1.0], "torque": 0.4}]),
    "pile": Scene.from_dict({"packing": PILE, "contact": {"friction": 0.3}}),
    "frictionless_pile": Scene.from_dict({"packing": PILE, "contact": {"friction": 0.0}}),
}


@pytest.mark.parametrize("name", SCENES)
def test_scene(name, num_regression):
    data = to_dataset(solve_scene(SCENES[name]))
    values = {
        "floor_force_rest": data.floor_force_rest.values,
        "floor_force": data.floor_force.values.ravel(),
        "x": data.position.values[-1, :, 0],
        "z": data.position.values[-1, :, 1],
        "angle": data.angle.values[-1],
        "normal_force": data.contact_normal_force.values[-1],
        "tangential_force": data.contact_tangential_force.values[-1],
        "status": data.contact_status.values[-1].astype(float),
    }
    num_regression.check(
        {key: np.asarray(value, float) for key, value in values.items()},
        basename=name,
        default_tolerance={"rtol": 1e-7, "atol": 1e-8},
        fill_different_shape_with_nan=True,
    )
