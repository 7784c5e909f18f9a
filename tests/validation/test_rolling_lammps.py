"""Small packings with rolling resistance against LAMMPS (tests/data/README.md), by motion and along a path."""

import json

import numpy as np
import pytest
from places import DATA

from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene

#: Largest difference of the normalised floor response, by motion as in LAMMPS and along a path, and of a floor force at
#: rest. A random packing remembers its fall: of forces at rest up to 2 %, of the response little.
LIMITS = {
    "slab_0.05": (1e-5, 5e-5, 2e-3),
    "slab_1": (1e-5, 5e-5, 2e-3),
    "pile": (1e-5, 5e-5, 2e-3),
    "polydisperse": (5e-4, 5e-4, 0.3),
}


@pytest.mark.parametrize("name", LIMITS)
def test_responses_agree_with_lammps(name):
    data = json.loads((DATA / f"lammps_rolling_{name}.json").read_text())
    assert max(data["kinetic_energy_per_disk"]) < 1e-20
    scene = Scene.from_dict(data["scene"])
    heights = [np.array(data[key]) for key in ("height_gravity", "height_loaded")]
    for method, limit in zip(("dynamics", "path"), LIMITS[name], strict=False):
        solution = solve_scene(scene.updated({"protocol.method": method}))
        problem, last = solution.problem, solution.loaded[-1]
        assert last.certificate.stable and last.certificate.rolling_excess < 1e-9
        radius, stiffness = problem.packing.radius, problem.wall_law.normal_stiffness
        floor = np.flatnonzero(heights[0] < radius)
        expected = [stiffness * np.maximum(radius - height, 0.0)[floor] for height in heights]
        found = [stiffness * np.maximum(radius - s.position[:, 1], 0.0)[floor] for s in (solution.rest, last)]
        assert found[0] == pytest.approx(expected[0], abs=LIMITS[name][2])
        response, other = ((one[1] - one[0]) / solution.total_force for one in (found, expected))
        assert response == pytest.approx(other, abs=limit)
    # it makes a difference
    free = {"contact.rolling_friction": 0.0, "wall.rolling_friction": 0.0}
    if name != "pile":  # which falls down without
        plain = solve_scene(scene.updated(free))
        z = [s.position[:, 1] for s in (plain.rest, plain.loaded[-1])]
        without = stiffness * (np.maximum(radius - z[1], 0.0) - np.maximum(radius - z[0], 0.0))[floor]
        assert np.abs(without / plain.total_force - other).max() > 20.0 * limit
