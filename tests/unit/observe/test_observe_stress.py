from dataclasses import replace

import numpy as np
import pytest
from observe_states import contacts, pair_index, slab, state, with_pairs
from scipy.integrate import quad

from granular_response.observe.stress import (
    ContactForces,
    antisymmetric_part,
    coarse_grained_stress,
    contact_forces,
    grid_points,
    line_forces,
    line_stress,
    load_forces,
    pressure,
)
from granular_response.state import FLOOR, LEFT_WALL, OPEN, RIGHT_WALL, STICKING


def one_contact(point, branch, force):
    return ContactForces(np.array([point]), np.array([branch]), np.array([force]))


@pytest.mark.parametrize("width", [0.7, 2.0])
def test_line_integral_against_quadrature(width):
    point, branch, force = np.array([0.3, -0.4]), np.array([1.2, 1.6]), np.array([0.7, -0.2])
    points = np.array([[0.0, 0.0], [0.3, -0.4], [-0.9, -2.0], [1.5, 0.5], [-0.3, -1.2]])
    stress = coarse_grained_stress(one_contact(point, branch, force), points, width, cutoff=20.0)
    for r, got in zip(points, stress, strict=True):

        def gaussian(s, r=r):
            return np.exp(-np.sum((r - point + s * branch) ** 2) / width**2) / (np.pi * width**2)

        np.testing.assert_allclose(got, np.outer(force, branch) * quad(gaussian, 0.0, 1.0)[0], rtol=1e-9)


def test_compression_is_positive_and_swapping_the_partners_changes_nothing():
    pushed = one_contact([1.0, 0.0], [2.0, 0.0], [3.0, 0.5])
    swapped = one_contact([-1.0, 0.0], [-2.0, 0.0], [-3.0, -0.5])
    points = np.array([[0.0, 0.0], [0.7, 1.1]])
    stress = coarse_grained_stress(pushed, points)
    np.testing.assert_allclose(stress, coarse_grained_stress(swapped, points), rtol=1e-14)
    assert np.all(stress[:, 0, 0] > 0.0)
    # force index first, branch index second
    np.testing.assert_allclose(stress[:, 1, 0] / stress[:, 0, 0], 0.5 / 3.0)
    assert np.all(stress[:, :, 1] == 0.0)


def test_cutoff_leaves_out_what_is_far_and_hardly_changes_the_rest():
    contact = one_contact([1.0, 0.0], [2.0, 0.0], [1.0, 0.0])
    points = np.array([[0.0, 0.0], [8.9, 0.0], [9.1, 0.0], [0.0, 5.0]])  # reach: 4 w and half the branch
    cut, full = (coarse_grained_stress(contact, points, cutoff=c)[:, 0, 0] for c in (4.0, 30.0))
    assert cut[2] == 0.0 < full[2]
    assert cut[1] > 0.0
    np.testing.assert_allclose(cut, full, atol=1e-7 * full[0])


def test_contacts_of_a_state_with_its_walls():
    position = np.array([[1.0, 1.0], [3.0, 1.0], [2.0, 2.7]])
    pairs = contacts([(0, 1), (2, 0)], np.array([0.0, 2.0]), 0.0, np.array([OPEN, STICKING]))
    walls = contacts([(1, FLOOR), (0, LEFT_WALL), (1, RIGHT_WALL)], np.array([1.0, 2.0, 3.0]), 0.25)
    found = contact_forces(state(position, pairs, walls))
    # The open pair is left out; branches run from the partner to the disk.
    np.testing.assert_allclose(found.point, [[2.0, 2.7], [3.0, 1.0], [1.0, 1.0], [3.0, 1.0]])
    np.testing.assert_allclose(found.branch, [[1.0, 1.7], [0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]])
    np.testing.assert_allclose(found.force[1:], [[-0.25, 1.0], [2.0, 0.25], [-3.0, -0.25]])
    np.testing.assert_allclose(found.force[0], 2.0 * np.array([1.0, 1.7]) / np.hypot(1.0, 1.7))


def test_added_forces_sit_in_the_loaded_geometry():
    rest = slab(2, 2)
    k = pair_index(rest, 0, 1)
    loaded = with_pairs(rest, k, normal_force=3.0)
    loaded = replace(loaded, position=rest.position + np.array([0.25, 0.0]))
    found = load_forces(rest, loaded)
    carries = np.any(np.abs(found.force) > 1e-12, axis=1)
    assert np.count_nonzero(carries) == 1
    i = rest.pairs.first[k]
    np.testing.assert_allclose(found.point[carries], loaded.position[[i]])
    np.testing.assert_allclose(np.abs(found.force[carries]), [[2.0, 0.0]])


def test_pressure_and_antisymmetric_part():
    stress = np.array([[[3.0, 0.5], [0.3, 1.0]], [[0.0, 1.0], [-1.0, 0.0]], [[-1.0, 0.0], [0.2, -1.0]]])
    np.testing.assert_allclose(pressure(stress), [2.0, 0.0, -1.0])
    np.testing.assert_allclose(antisymmetric_part(stress), [0.1, 1.0, -0.1])


def test_what_crosses_a_line_does_so_where_the_branch_crosses_it():
    contact = one_contact([1.0, 3.0], [1.0, 2.0], [0.3, 0.8])  # pushes the upper disk up: compression
    at, force = line_forces(contact, 1.5)
    assert (at.tolist(), force.tolist()) == ([0.25], [0.8])
    swapped = one_contact([0.0, 1.0], [-1.0, -2.0], [-0.3, -0.8])
    assert line_forces(swapped, 1.5)[1].tolist() == [0.8]
    assert line_forces(contact, 3.5)[0].size == 0
    x = np.array([0.25, 1.25])
    assert line_stress(contact, 1.5, x, 2.0) == pytest.approx(0.8 * np.exp([0.0, -0.25]) / (2.0 * np.sqrt(np.pi)))


def test_the_stress_is_the_mean_over_heights_of_that_on_lines():
    """Both hand down the same force: a strip in x and z of the one is a strip in x of the other."""
    contact = one_contact([1.0, 3.0], [1.0, 2.0], [0.3, 0.8])
    x, z = np.arange(-9.0, 11.0, 0.1), np.arange(-8.0, 13.0, 0.1)
    whole = coarse_grained_stress(contact, grid_points(x, z), 1.5, cutoff=12.0)[..., 1, 1].sum(axis=0) * 0.1
    lines = sum(line_stress(contact, height, x, 1.5) for height in np.arange(1.005, 3.0, 0.01)) * 0.01
    assert whole == pytest.approx(lines, abs=1e-6)
