"""A disordered packing at rest is in equilibrium, overlaps no more than its forces need, and weighs what it weighs.

Everything is measured anew from positions and contact forces, over all pairs of disks and not only those that the
neighbour list knows.
"""

import numpy as np
import pytest

from granular_response.scene import Scene
from granular_response.solve import Problem, rest_state
from granular_response.state import FLOOR

CASES = [(0.25, 0.0, 2.0), (0.25, 0.2, 2.0), (0.25, 1.0, 2.0), (0.1, 0.2, "touching-largest"), (0.01, 0.0, 2.0)]


@pytest.fixture(scope="module", params=CASES, ids=str)
def packing(request):
    polydispersity, friction, lattice_constant = request.param
    scene = Scene().updated(
        {
            "packing.layers": 8,
            "packing.disks_per_row": 17,
            "packing.polydispersity": polydispersity,
            "packing.lattice_constant": lattice_constant,
            "contact.friction": friction,
            "wall.friction": friction,
            "loads": [],
            "protocol.integrator": "verlet",
            "protocol.time_step": "auto",
        }
    )
    problem = Problem.from_scene(scene)
    return problem, rest_state(problem)


def test_equilibrium_is_certified_and_stable(packing) -> None:
    _, rest = packing
    certificate = rest.certificate
    assert certificate.force_residual < 1e-9
    assert certificate.torque_residual < 1e-9
    assert certificate.coulomb_excess < 1e-9
    assert certificate.smallest_normal_force > 0.0
    assert certificate.stable


def test_forces_on_every_disk_add_up_to_zero(packing) -> None:
    problem, rest = packing
    pairs, walls, radius = rest.pairs, rest.walls, problem.packing.radius
    force = np.zeros((problem.n, 2))
    force[:, 1] = -problem.packing.mass
    torque = np.zeros(problem.n)
    for c, on_first in enumerate(rest.pair_force()):
        i, j = pairs.first[c], pairs.second[c]
        force[i] += on_first
        force[j] -= on_first
        torque[i] -= radius[i] * pairs.tangential_force[c]
        torque[j] -= radius[j] * pairs.tangential_force[c]
    for c, on_disk in enumerate(rest.wall_force()):
        force[walls.first[c]] += on_disk
        torque[walls.first[c]] -= radius[walls.first[c]] * walls.tangential_force[c]
    assert np.abs(force).max() < 1e-9
    assert np.abs(torque).max() < 1e-9


def test_disks_overlap_only_where_a_force_says_so(packing) -> None:
    problem, rest = packing
    radius, stiffness = problem.packing.radius, problem.scene.contact.normal_stiffness
    distance = np.linalg.norm(rest.position[:, None] - rest.position[None], axis=-1)
    overlap = np.triu(radius[:, None] + radius[None] - distance, 1)
    expected = np.zeros_like(overlap)
    low = np.minimum(rest.pairs.first, rest.pairs.second)
    high = np.maximum(rest.pairs.first, rest.pairs.second)
    expected[low, high] = rest.pairs.normal_force / stiffness
    np.testing.assert_allclose(np.maximum(overlap, 0.0), expected, atol=1e-13)
    assert rest.pairs.normal_force.max() < problem.packing.mass.sum()


def test_walls_are_entered_only_where_a_force_says_so(packing) -> None:
    problem, rest = packing
    radius, width = problem.packing.radius, problem.packing.width
    stiffness = problem.scene.resolved_wall.normal_stiffness
    x, z = rest.position.T
    overlap = np.stack([radius - z, radius - x, radius - (width - x)], axis=1)
    expected = np.zeros_like(overlap)
    expected[rest.walls.first, rest.walls.second] = rest.walls.normal_force / stiffness
    np.testing.assert_allclose(np.maximum(overlap, 0.0), expected, atol=1e-13)


def test_floor_and_walls_bear_the_weight(packing) -> None:
    problem, rest = packing
    vertical = rest.wall_force()[:, 1]
    weight = float(problem.packing.mass.sum())
    np.testing.assert_allclose(vertical.sum(), weight, rtol=1e-11)
    on_floor = float(vertical[rest.walls.second == FLOOR].sum())
    if problem.wall_friction:
        assert 0.5 * weight < on_floor
        assert abs(on_floor - weight) > 1e-6  # side walls bear a part of it
    else:
        np.testing.assert_allclose(on_floor, weight, rtol=1e-11)


def test_no_disk_is_lost_or_in_flight(packing) -> None:
    """Disks that the first overlaps throw up have come back, and lie on others."""
    problem, rest = packing
    contacts = np.zeros(problem.n, dtype=int)
    for kind in (rest.pairs, rest.walls):
        touching = kind.normal_force > 0.0
        np.add.at(contacts, kind.first[touching], 1)
        if kind is rest.pairs:
            np.add.at(contacts, kind.second[touching], 1)
    assert contacts.min() >= 1
    assert np.count_nonzero(contacts < 2) == rest.certificate.loose_disks
    assert np.all(rest.velocity == 0.0)
    assert np.all((rest.position[:, 0] > 0.0) & (rest.position[:, 0] < problem.packing.width))
    assert np.all(rest.position[:, 1] > 0.0)
