"""Observables of hand-made states: events, floor forces, profiles, differences of states."""

import numpy as np
import pytest
from observe_states import contacts, state
from refusals import refusals

from granular_response.observe.difference import (
    match_candidates,
    pair_force_difference,
    wall_force_difference,
)
from granular_response.observe.floor import floor_disks, floor_force, floor_response, interior_mask, smoothed_response
from granular_response.state import FLOOR, LEFT_WALL, OPEN, RIGHT_WALL, SLIDING, STICKING


def three_disks(floor_force=(1.0, 2.0, 0.0), status=(STICKING, STICKING, OPEN)):
    """Disks 0, 1, 2 from right to left; disk 1 also leans on the side walls with friction."""
    walls = contacts(
        [(0, FLOOR), (1, FLOOR), (2, FLOOR), (1, LEFT_WALL), (1, RIGHT_WALL)],
        normal_force=np.array([*floor_force, 5.0, 6.0]),
        tangential_force=np.array([0.3, 0.4, 0.0, 0.7, 0.8]),
        status=np.array([*status, STICKING, STICKING]),
    )
    return state(np.array([[5.0, 1.0], [3.0, 1.0], [1.0, 1.2]]), contacts([]), walls)


def test_floor_disks_are_ordered_by_x_and_come_from_row_or_touch():
    rest = three_disks()
    assert floor_disks([rest]).tolist() == [1, 0]
    assert floor_disks([rest], bottom_row=[2, 0]).tolist() == [2, 1, 0]
    lowered = three_disks(status=(STICKING, OPEN, STICKING))
    assert floor_disks([rest, lowered]).tolist() == [2, 1, 0]


def test_floor_force_is_vertical_and_leaves_out_the_side_walls():
    np.testing.assert_array_equal(floor_force(three_disks(), np.array([2, 1, 0])), [0.0, 2.0, 1.0])


def test_floor_response_is_the_difference_per_applied_force():
    rest, loaded = three_disks(), three_disks((1.5, 5.0, 0.5), (STICKING,) * 3)
    disks = floor_disks([rest, loaded])
    np.testing.assert_allclose(floor_response(rest, loaded, disks, 4.0), [0.125, 0.75, 0.125])


def test_smoothed_response_keeps_its_integral_and_has_the_stated_kernel():
    x_disk, response = np.array([-2.0, 0.0, 2.0]), np.array([0.2, 0.5, 0.4])
    x = np.linspace(-30.0, 30.0, 6001)
    smooth = smoothed_response(x, x_disk, response, 3.0)
    assert np.sum(smooth) * (x[1] - x[0]) == pytest.approx(response.sum(), rel=1e-10)
    single = smoothed_response([1.0, 4.0], [1.0], [2.0], 3.0)
    np.testing.assert_allclose(single, 2.0 / (3.0 * np.sqrt(np.pi)) * np.array([1.0, np.exp(-1.0)]))


def test_interior_leaves_out_ten_radii_at_both_walls():
    x = np.arange(-60.0, 61.0, 2.0)  # the floor disks of the default slab, from the loaded disk
    inside = x[interior_mask(x, 122.0, left_wall=-61.0)]
    assert (inside[0], inside[-1]) == (-50.0, 50.0)
    assert interior_mask(np.array([9.9, 10.0, 90.0, 90.1]), 100.0).tolist() == [False, True, True, False]


PLACES = np.array([[1.0, 1.0], [3.0, 1.0]])
GOOD, TWICE = state(PLACES, contacts([(0, 1)])), state(PLACES, contacts([(0, 1), (1, 0)]))
test_what_cannot_be_is_named = refusals(
    ValueError,
    (lambda: floor_disks([]), "states"),
    *(
        (lambda force=force: floor_response(three_disks(), three_disks(), np.array([0]), force), "total_force")
        for force in (0.0, -1.0, np.nan, np.inf)
    ),
    (lambda: smoothed_response([0.0], [0.0], [1.0], 0.0), "width"),
    (lambda: interior_mask(np.array([5.0]), 20.0, 10.0), "margin"),
    (lambda: match_candidates(GOOD, TWICE, np.ones(2)), "twice"),
    (lambda: match_candidates(GOOD, GOOD, np.ones(3)), "radius"),
)


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
    assert a.pairs.same_candidates(b.pairs) and a.walls.same_candidates(b.walls)
    assert list(zip(a.pairs.first, a.pairs.second, strict=True)) == [(0, 1), (0, 2), (1, 2)]
    assert a.pairs.status.tolist() == [STICKING, OPEN, SLIDING]
    assert b.pairs.status.tolist() == [OPEN, OPEN, STICKING]
    # The force on each disk is what it was.
    for before, after in ((rest, a), (loaded, b)):
        for disk in range(3):
            np.testing.assert_allclose(total(after, disk), total(before, disk), atol=1e-15)
    # Overlaps of contacts that were not listed come from the geometry.
    assert b.pairs.overlap[0] == pytest.approx(1.8 - np.hypot(2.0, 0.1))
    walls = [(0, FLOOR), (0, LEFT_WALL), (2, RIGHT_WALL)]
    assert list(zip(a.walls.first, a.walls.second, strict=True)) == walls
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
