"""The coarse-grained stress balances gravity and load (Secs. V.C and V.D).

Random disks with arbitrary contact forces, whose body forces are then whatever balances them, and solved slabs.
"""

from __future__ import annotations

import numpy as np
import pytest
from observe_states import contacts, state
from scipy.spatial import Delaunay
from small_scenes import pushed, scene

from granular_response.observe.stress import (
    ContactForces,
    coarse_grained_stress,
    contact_forces,
    couple_stress,
    grid_points,
)
from granular_response.solvers.solution import solve_scene
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, State

#: Far enough for the Gaussian to be below rounding, where a test wants the identity itself.
WHOLE = 7.0


def body_force_density(position: np.ndarray, force: np.ndarray, points: np.ndarray, w: float) -> np.ndarray:
    """Coarse-grained density of point forces (both (n, 2)) at ``points`` (..., 2), by its definition."""
    distance2 = np.sum((points[..., None, :] - position) ** 2, axis=-1)
    return np.exp(-distance2 / w**2) @ force / (np.pi * w**2)


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


@pytest.mark.parametrize("w", [0.8, 2.0])
def test_divergence_is_the_body_force_and_the_push_of_the_walls(w):
    s, width = random_packing()
    points = grid_points(np.linspace(0.0, width, 9), np.linspace(0.0, 12.0, 8))
    got = divergence(contact_forces(s), points, w)
    expected = body_force_density(s.position, outer_force(s), points, w)
    expected += body_force_density(wall_points(s, width), s.wall_force(), points, w)
    np.testing.assert_allclose(got, expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("w", [0.8, 2.0])
def test_divergence_of_the_couple_stress_is_the_torque_of_the_tangential_forces(w):
    """With unequal disks, rolling resistance at disks and walls, and a torque as a load: the torques balance."""
    rolls = {"friction": 0.4, "rolling_friction": 0.1, "rolling_stiffness_ratio": 0.5}
    described = scene(4, 8, packing__polydispersity=0.2, loads=pushed(0.2, -2.0, 0.3))
    solved = solve_scene(described.updated({"contact": rolls, "wall": rolls}))
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
