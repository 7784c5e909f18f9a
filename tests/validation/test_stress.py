"""The coarse-grained stress balances gravity and load (Secs. V.C and V.D).

Two packings: random disks with arbitrary contact forces, whose body forces are then whatever balances
them, and a triangular slab under gravity and a point load, whose contact forces solve the equations of
equilibrium.
"""

from __future__ import annotations

import numpy as np
import pytest
from observe_states import contacts, state
from scipy.spatial import Delaunay
from scipy.special import erf

from granular_response.observe.floor import floor_disks, floor_force
from granular_response.observe.stress import (
    ContactForces,
    antisymmetric_part,
    coarse_grained_stress,
    contact_forces,
    couple_stress,
    grid_points,
    load_forces,
    pressure,
)
from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, State

#: Far enough for the Gaussian to be below rounding, where a test wants the identity itself.
WHOLE = 7.0


def body_force_density(position: np.ndarray, force: np.ndarray, points: np.ndarray, w: float) -> np.ndarray:
    """Coarse-grained density of point forces (both (n, 2)) at ``points`` (..., 2), by its definition."""
    distance2 = np.sum((points[..., None, :] - position) ** 2, axis=-1)
    return np.exp(-distance2 / w**2) @ force / (np.pi * w**2)


def antisymmetric_ratio(stress: np.ndarray) -> np.ndarray:
    """Magnitude of the antisymmetric part per magnitude of the pressure."""
    return np.abs(antisymmetric_part(stress) / pressure(stress))


def divergence(forces: ContactForces, points: np.ndarray, w: float, h: float = 1e-3) -> np.ndarray:
    """d sigma_ab / d r_b at points, by central differences of fourth order."""
    total = np.zeros(points.shape)
    for b in range(2):
        step = np.zeros(2)
        step[b] = h
        for k, weight in ((1, 8.0), (2, -1.0)):
            above = coarse_grained_stress(forces, points + k * step, w, WHOLE)[..., b]
            below = coarse_grained_stress(forces, points - k * step, w, WHOLE)[..., b]
            total += weight * (above - below) / (12.0 * h)
    return total


def wall_points(s: State, width: float) -> np.ndarray:
    point = s.position[s.walls.first].copy()
    point[s.walls.second == FLOOR, 1] = 0.0
    point[s.walls.second == LEFT_WALL, 0] = 0.0
    point[s.walls.second == RIGHT_WALL, 0] = width
    return point


def outer_force(s: State) -> np.ndarray:
    """(n, 2) force that must act on each disk from outside for equilibrium."""
    force = np.zeros(s.position.shape)
    np.add.at(force, s.pairs.first, -s.pair_force())
    np.add.at(force, s.pairs.second, s.pair_force())
    np.add.at(force, s.walls.first, -s.wall_force())
    return force


def random_packing() -> tuple[State, float]:
    rng = np.random.default_rng(20)
    width = 14.0
    position = rng.uniform([1.0, 1.0], [width - 1.0, 11.0], size=(40, 2))
    links = {tuple(sorted((int(t[i]), int(t[i - 1])))) for t in Delaunay(position).simplices for i in range(3)}
    walls = [(i, FLOOR) for i in range(40) if position[i, 1] < 3.0]
    walls += [(i, LEFT_WALL) for i in range(40) if position[i, 0] < 3.0]
    walls += [(i, RIGHT_WALL) for i in range(40) if position[i, 0] > width - 3.0]
    pairs = contacts(sorted(links), rng.normal(size=len(links)), rng.normal(size=len(links)))
    at_walls = contacts(walls, rng.normal(size=len(walls)), rng.normal(size=len(walls)))
    return state(position, pairs, at_walls, width), width


def slab_in_equilibrium(load: float, layers: int = 9, long_row: int = 15) -> tuple[State, float]:
    """Triangular slab; smallest contact forces (normal and tangential) that carry weight 1 and the load."""
    row = np.sqrt(3.0)
    rows = [[(1.0 + k % 2 + 2.0 * i, 1.0 + k * row) for i in range(long_row - k % 2)] for k in range(layers)]
    position = np.array([p for r in rows for p in r])
    n, width = len(position), 2.0 * long_row
    gap = np.linalg.norm(position[:, None] - position[None], axis=2)
    links = [(i, j) for i in range(n) for j in range(i + 1, n) if gap[i, j] < 2.001]
    walls = [(i, FLOOR) for i in range(long_row)]
    walls += [(i, LEFT_WALL) for i in range(n) if position[i, 0] < 1.001]
    walls += [(i, RIGHT_WALL) for i in range(n) if position[i, 0] > width - 1.001]

    m, w = len(links), len(walls)
    matrix = np.zeros((3 * n, 2 * m + 2 * w))  # forces and torque on each disk per contact force
    for c, (i, j) in enumerate(links):
        normal = (position[i] - position[j]) / 2.0
        tangent = np.array([-normal[1], normal[0]])
        for column, direction in ((c, normal), (m + c, tangent)):
            matrix[2 * i : 2 * i + 2, column] += direction
            matrix[2 * j : 2 * j + 2, column] -= direction
        matrix[2 * n + np.array([i, j]), m + c] = -1.0
    for c, (i, wall) in enumerate(walls):
        normal = WALL_NORMAL[wall]
        tangent = np.array([-normal[1], normal[0]])
        matrix[2 * i : 2 * i + 2, 2 * m + c] += normal
        matrix[2 * i : 2 * i + 2, 2 * m + w + c] += tangent
        matrix[2 * n + i, 2 * m + w + c] = -1.0
    outer = np.zeros(3 * n)
    outer[1 : 2 * n : 2] = -1.0
    loaded = n - (long_row + 1) // 2
    outer[2 * loaded + 1] -= load
    force = np.linalg.lstsq(matrix, -outer, rcond=None)[0]
    assert np.abs(matrix @ force + outer).max() < 1e-10
    return state(
        position,
        contacts(links, force[:m], force[m : 2 * m]),
        contacts(walls, force[2 * m : 2 * m + w], force[2 * m + w :]),
        width,
    ), width


@pytest.mark.parametrize("w", [0.8, 2.0])
def test_divergence_is_the_body_force_and_the_push_of_the_walls(w):
    s, width = random_packing()
    points = grid_points(np.linspace(0.0, width, 9), np.linspace(0.0, 12.0, 8))
    got = divergence(contact_forces(s), points, w)
    expected = body_force_density(s.position, outer_force(s), points, w)
    expected += body_force_density(wall_points(s, width), s.wall_force(), points, w)
    np.testing.assert_allclose(got, expected, atol=1e-9 * np.abs(expected).max())


def test_slab_under_gravity_balances_its_weight_in_the_interior():
    s, _ = slab_in_equilibrium(0.0)
    w = 2.0
    points = grid_points(np.linspace(9.5, 20.5, 9), np.array([7.3, 8.1]))
    got = divergence(contact_forces(s), points, w)
    weight = body_force_density(s.position, np.tile([0.0, -1.0], (len(s.position), 1)), points, w)
    # What is left are the tails of the wall forces, 7.3 (3.6 w) and more away.
    np.testing.assert_allclose(got, weight, atol=2e-4 * np.abs(weight).max())
    # One disk per 2 sqrt(3) of area: pressure falls upwards at that rate.
    np.testing.assert_allclose(got[..., 1], -1.0 / (2.0 * np.sqrt(3.0)), rtol=0.01)


def line_integral(forces: ContactForces, z: float, width: float, w: float = 2.0) -> float:
    x = np.linspace(-8.0 * w, width + 8.0 * w, 601)
    stress = coarse_grained_stress(forces, grid_points(x, np.array([z])), w, WHOLE)
    return float(stress[0, :, 1, 1].sum() * (x[1] - x[0]))


def test_sigma_zz_over_a_line_carries_the_load_above_it():
    load = 12.0
    (rest, width), (loaded, _) = slab_in_equilibrium(0.0), slab_in_equilibrium(load)
    # Side walls with friction carry a share; below the line it is what they do not take above it.
    for z, tolerance in ((6.5, 2e-4), (7.5, 2e-5)):
        side = loaded.walls.second != FLOOR
        height = loaded.position[loaded.walls.first, 1]
        force = loaded.wall_force() - rest.wall_force()
        # A point force is counted above the line to the extent of its smeared-out share there.
        share = 0.5 * (1.0 + erf((height[side] - z) / 2.0))
        expected = load - np.sum(force[side, 1] * share)
        assert line_integral(load_forces(rest, loaded), z, width) == pytest.approx(expected, rel=tolerance)
    weight_and_load = line_integral(contact_forces(loaded), 7.0, width)
    only_load = line_integral(load_forces(rest, loaded), 7.0, width)
    assert weight_and_load - only_load == pytest.approx(line_integral(contact_forces(rest), 7.0, width))


def test_sigma_zz_just_above_the_floor_carries_the_floor_force():
    """With a Gaussian much narrower than a disk, the stress below the bottom row is the floor force."""
    s, width = slab_in_equilibrium(12.0)
    floor = floor_force(s, floor_disks([s])).sum()
    w = 0.1
    x = np.linspace(-1.0, width + 1.0, 6401)
    stress = coarse_grained_stress(contact_forces(s), grid_points(x, np.array([0.5])), w, WHOLE)
    assert stress[0, :, 1, 1].sum() * (x[1] - x[0]) == pytest.approx(floor, rel=1e-9)


def test_load_needs_no_gravity_in_the_balance():
    load = 12.0
    (rest, width), (loaded, _) = slab_in_equilibrium(0.0), slab_in_equilibrium(load)
    s = load_forces(rest, loaded)
    top = int(np.argmin(outer_force(loaded)[:, 1]))
    points = grid_points(np.linspace(6.0, 24.0, 13), np.linspace(8.0, 17.0, 9))
    got = divergence(s, points, 2.0)
    expected = body_force_density(loaded.position[[top]], np.array([[0.0, -load]]), points, 2.0)
    walls = body_force_density(wall_points(loaded, width), loaded.wall_force() - rest.wall_force(), points, 2.0)
    np.testing.assert_allclose(got, expected + walls, atol=1e-8)
    assert np.abs(walls).max() < 0.02 * np.abs(expected).max()


def test_antisymmetric_part_is_small_when_torques_balance():
    """Torque balance makes the stress symmetric up to gradients over a disk; without it, it is not."""
    s, width = slab_in_equilibrium(0.0)
    points = grid_points(np.linspace(9.0, 21.0, 7), np.array([7.0, 9.0]))
    balanced = antisymmetric_ratio(coarse_grained_stress(contact_forces(s), points))
    assert balanced.max() < 0.02
    spun = contacts(
        list(zip(s.pairs.first.tolist(), s.pairs.second.tolist(), strict=True)),
        s.pairs.normal_force,
        s.pairs.tangential_force + 1.0,
    )
    forces = contact_forces(state(s.position, spun, s.walls, width))
    turned = antisymmetric_ratio(coarse_grained_stress(forces, points))
    assert turned.min() > 0.2


@pytest.mark.parametrize("w", [0.8, 2.0])
def test_divergence_of_the_couple_stress_is_the_torque_of_the_tangential_forces(w):
    """With unequal disks, rolling resistance at disks and walls, and a torque as a load: the torques balance."""
    rolls = {"friction": 0.4, "rolling_friction": 0.1, "rolling_stiffness_ratio": 0.5}
    load = {"disk": "top-centre", "force": [0.2, -2.0], "torque": 0.3}
    packing = {"kind": "slab", "layers": 4, "disks_per_row": 8, "polydispersity": 0.2}
    solved = solve_scene(Scene.from_dict({"packing": packing, "contact": rolls, "wall": rolls, "loads": [load]}))
    s, radius = solved.loaded[-1], solved.problem.packing.radius
    points = grid_points(np.linspace(0.0, 16.0, 7), np.linspace(-0.5, 8.0, 6))

    def field(at: np.ndarray) -> np.ndarray:
        return couple_stress(s, radius, at, w, WHOLE)

    h = 1e-3
    steps = enumerate(h * np.eye(2))
    got = sum((field(points + step)[..., b] - field(points - step)[..., b]) / (2.0 * h) for b, step in steps)
    on_disk, on_wall = np.zeros_like(s.position), np.zeros((len(s.walls.first), 2))
    both = 0.5 * (radius[s.pairs.first] + radius[s.pairs.second]) * s.pairs.tangential_force
    for disk in (s.pairs.first, s.pairs.second):
        np.add.at(on_disk[:, 0], disk, -both)
    half = 0.5 * radius[s.walls.first] * s.walls.tangential_force
    np.add.at(on_disk[:, 0], s.walls.first, -half)
    on_wall[:, 0] = radius[s.walls.first] * s.walls.rolling_force - half
    on_disk[solved.problem.load_disk[0], 0] += 0.3
    at_walls = s.box.on_wall(s.position[s.walls.first], s.walls.second)
    expected = body_force_density(s.position, on_disk, points, w) + body_force_density(at_walls, on_wall, points, w)
    assert np.abs(s.pairs.rolling_force).max() > 1e-3
    np.testing.assert_allclose(got, expected[..., 0], atol=1e-5 * np.abs(expected).max())
