"""Floor forces against LAMMPS (tests/data/README.md): the paper's slab, and small packings with rolling resistance."""

import json

import numpy as np
import pytest
from places import DATA
from solved import FLOOR_DISKS, response, slab

from granular_response.observe.floor import floor_force
from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene

#: Largest difference of the normalised response: dynamics as in LAMMPS, and the quasi-static limit of the ramp.
LIMITS = {
    ("0", "auto"): 2e-6,
    ("0.2", "dynamics"): 4e-6,
    ("1", "dynamics"): 1e-5,
    ("0.2", "path"): 5e-5,
    ("1", "path"): 5e-5,
}


def reference(friction: str) -> dict:
    return json.loads((DATA / f"lammps_mu{friction}_F4.json").read_text())


@pytest.mark.parametrize(("friction", "method"), LIMITS)
def test_response_agrees_with_lammps(friction, method):
    solution = slab(float(friction), 4.0, method)
    expected = np.array(reference(friction)["tol_1e-22"]["response"])
    assert response(solution) == pytest.approx(expected, abs=LIMITS[friction, method], rel=0)


@pytest.mark.parametrize(
    ("friction", "method", "limit"), [("0", "auto", 2e-6), ("0.2", "dynamics", 3e-3), ("1", "dynamics", 3e-3)]
)
def test_floor_forces_at_rest_agree_with_lammps(friction, method, limit):
    """With friction the rest state remembers the fall, and with it the integrator and its time step."""
    expected = np.array(reference(friction)["tol_1e-22"]["floor_force_gravity"])
    rest = slab(float(friction), 4.0, method).rest
    assert floor_force(rest, FLOOR_DISKS) == pytest.approx(expected, abs=limit, rel=0)


@pytest.mark.parametrize(("friction", "method"), [("0", "auto"), ("0.2", "dynamics"), ("1", "dynamics")])
def test_contact_network_agrees_with_lammps(friction, method):
    """The number of closed contacts, but for those closer to opening than two codes agree."""
    solution = slab(float(friction), 4.0, method)
    for state, key in ((solution.rest, "contacts_gravity"), (solution.loaded[-1], "contacts_loaded")):
        expected = reference(friction)["tol_1e-22"][key]
        doubtful = int((np.abs(state.pairs.overlap) < 1e-7).sum())
        assert abs(int(state.pairs.touching.sum()) - expected["closed"]) <= doubtful
        assert state.pairs.overlap.max() == pytest.approx(expected["max_overlap"], rel=2e-4)


#: The same with the 3/2 law. Without friction the slab as it stands has equilibria of nearly the same energy, and each
#: code falls into another: its rows are pressed together.
HERTZ_LIMITS = {("0", "auto"): 1e-7, ("0.2", "dynamics"): 5e-5, ("0.2", "path"): 5e-5, ("1", "dynamics"): 5e-5}


@pytest.mark.parametrize(("friction", "method"), HERTZ_LIMITS)
def test_the_three_halves_law_agrees_with_lammps(friction, method):
    expected = json.loads((DATA / f"lammps_hertz_mu{friction}_F4.json").read_text())
    assert max(expected["kinetic_energy_per_disk"]) < 1e-18
    solution = slab(float(friction), 4.0, method, "hertz", expected["lattice_constant"])
    assert response(solution) == pytest.approx(
        np.array(expected["response"]), abs=HERTZ_LIMITS[friction, method], rel=0
    )
    rest = floor_force(solution.rest, FLOOR_DISKS)
    limit = 2e-2 if float(friction) else 1e-5
    assert rest == pytest.approx(np.array(expected["floor_force_gravity"]), abs=limit, rel=0)
    if method == "auto":  # and the linear law is another one
        linear = response(slab(float(friction), 4.0, method, "linear", expected["lattice_constant"]))
        assert np.abs(linear - expected["response"]).max() > 1e-3


#: Largest difference of the normalised floor response, by motion as in LAMMPS and along a path, and of a floor force at
#: rest. A random packing remembers its fall: of forces at rest up to 2 %, of the response little.
ROLLING_LIMITS = {
    "slab_0.05": (1e-5, 5e-5, 2e-3),
    "slab_1": (1e-5, 5e-5, 2e-3),
    "pile": (1e-5, 5e-5, 2e-3),
    "polydisperse": (5e-4, 5e-4, 0.3),
}


@pytest.mark.parametrize("name", ROLLING_LIMITS)
def test_responses_with_rolling_resistance_agree_with_lammps(name):
    data = json.loads((DATA / f"lammps_rolling_{name}.json").read_text())
    assert max(data["kinetic_energy_per_disk"]) < 1e-20
    scene = Scene.from_dict(data["scene"])
    heights = [np.array(data[key]) for key in ("height_gravity", "height_loaded")]
    for method, limit in zip(("dynamics", "path"), ROLLING_LIMITS[name], strict=False):
        solution = solve_scene(scene.updated({"protocol.method": method}))
        problem, last = solution.problem, solution.loaded[-1]
        assert last.certificate.stable and last.certificate.rolling_excess < 1e-9
        radius, stiffness = problem.packing.radius, problem.wall_law.normal_stiffness
        floor = np.flatnonzero(heights[0] < radius)
        expected = [stiffness * np.maximum(radius - height, 0.0)[floor] for height in heights]
        found = [stiffness * np.maximum(radius - s.position[:, 1], 0.0)[floor] for s in (solution.rest, last)]
        assert found[0] == pytest.approx(expected[0], abs=ROLLING_LIMITS[name][2])
        response, other = ((one[1] - one[0]) / solution.total_force for one in (found, expected))
        assert response == pytest.approx(other, abs=limit)
    # it makes a difference
    free = {"contact.rolling_friction": 0.0, "wall.rolling_friction": 0.0}
    if name != "pile":  # which falls down without
        plain = solve_scene(scene.updated(free))
        z = [s.position[:, 1] for s in (plain.rest, plain.loaded[-1])]
        without = stiffness * (np.maximum(radius - z[1], 0.0) - np.maximum(radius - z[0], 0.0))[floor]
        assert np.abs(without / plain.total_force - other).max() > 20.0 * limit
