
import numpy as np
import pytest
from observe_states import contacts, pair_index, slab, state, with_pairs

from granular_response.observe.difference import (
    force_misalignment,
    match_candidates,
    pair_force_difference,
    require_same_candidates,
    wall_force_difference,
)
from granular_response.state import FLOOR, LEFT_WALL, OPEN, RIGHT_WALL, SLIDING, STICKING


def two(angle, normal, tangential):
    """Two disks whose line of centres makes ``angle`` with the horizontal; 0 is the upper right one."""
    position = np.array([[2.0 * np.cos(angle), 2.0 * np.sin(angle)], [0.0, 0.0]]) + 5.0
    walls = contacts([(1, FLOOR)], normal_force=normal, tangential_force=tangential)
    return state(position, contacts([(0, 1)], normal, tangential), walls)


def test_forces_are_subtracted_as_vectors_in_their_own_geometry():
    rest, loaded = two(0.0, 1.0, 0.0), two(np.pi / 2, 3.0, 0.5)
    # Force on disk 0: (1, 0) at rest, 3 z + 0.5 (-x) under load.
    np.testing.assert_allclose(pair_force_difference(rest, loaded), [[-1.5, 3.0]], atol=1e-15)
    # Floor: normal upwards, tangent to the left.
    np.testing.assert_allclose(wall_force_difference(rest, loaded), [[-0.5, 2.0]], atol=1e-15)


def test_misalignment_is_the_weighted_angle_to_the_contact_line():
    rest = slab(2, 2)
    first, second = pair_index(rest, 0, 1), pair_index(rest, 0, 2)
    along = with_pairs(rest, first, normal_force=4.0)
    assert force_misalignment(rest, along) == pytest.approx(0.0, abs=1e-12)
    # 3 along its contact, and 1 across another: a quarter of the weight at a right angle.
    both = with_pairs(along, second, tangential_force=-1.0)
    assert force_misalignment(rest, both) == pytest.approx(np.pi / 8)
    pulled = with_pairs(rest, first, normal_force=-2.0)
    assert force_misalignment(rest, pulled) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(force_misalignment(rest, rest))


def test_matching_gives_one_list_and_keeps_the_forces():
    radius = np.array([1.0, 0.8, 1.2])
    width = 6.0
    position = np.array([[1.0, 0.9], [3.0, 0.8], [4.9, 1.2]])
    rest = state(
        position,
        contacts([(0, 1), (2, 1)], np.array([1.0, 2.0]), np.array([0.1, -0.2]), np.array([STICKING, SLIDING])),
        contacts([(0, FLOOR), (2, RIGHT_WALL)], np.array([3.0, 4.0])),
        width,
    )
    loaded = state(
        position + np.array([0.1, 0.05]),
        contacts([(1, 2), (0, 2)], np.array([5.0, 0.0]), np.array([0.5, 0.0]), np.array([STICKING, OPEN])),
        contacts([(0, LEFT_WALL), (0, FLOOR)], np.array([6.0, 7.0])),
        width,
    )
    a, b = match_candidates(rest, loaded, radius)
    require_same_candidates(a, b)
    assert list(zip(a.pairs.first, a.pairs.second, strict=True)) == [(0, 1), (0, 2), (1, 2)]
    assert a.pairs.status.tolist() == [STICKING, OPEN, SLIDING]
    assert b.pairs.status.tolist() == [OPEN, OPEN, STICKING]
    # The force on each disk is what it was.
    for before, after in ((rest, a), (loaded, b)):
        for disk in range(3):
            np.testing.assert_allclose(total(after, disk), total(before, disk), atol=1e-15)
    # Overlaps of contacts that were not listed come from the geometry.
    assert b.pairs.overlap[0] == pytest.approx(1.8 - np.hypot(2.0, 0.1))
    assert list(zip(a.walls.first, a.walls.second, strict=True)) == [
        (0, FLOOR),
        (0, LEFT_WALL),
        (2, RIGHT_WALL),
    ]
    assert a.walls.status.tolist() == [STICKING, OPEN, STICKING]
    assert a.walls.overlap[1] == pytest.approx(0.0)
    assert b.walls.overlap[2] == pytest.approx(1.2 - (6.0 - 5.0))


def total(s, disk):
    force, wall = s.pair_force(), s.wall_force()
    pairs = s.pairs
    return (
        force[pairs.first == disk].sum(axis=0)
        - force[pairs.second == disk].sum(axis=0)
        + wall[s.walls.first == disk].sum(axis=0)
    )


def test_matching_refuses_doubles_and_other_packings():
    position = np.array([[1.0, 1.0], [3.0, 1.0]])
    good, bad = state(position, contacts([(0, 1)])), state(position, contacts([(0, 1), (1, 0)]))
    with pytest.raises(ValueError, match="twice"):
        match_candidates(good, bad, np.ones(2))
    with pytest.raises(ValueError, match="radius"):
        match_candidates(good, good, np.ones(3))
