from dataclasses import replace

import numpy as np
import pytest
from observe_states import contacts, opened, slab, state
from refusals import refusals

from granular_response.observe import network
from granular_response.state import FLOOR, OPEN, SLIDING, STICKING


def test_contacts_open_between_all_statuses():
    before = np.repeat([OPEN, STICKING, SLIDING], 3)
    after = np.tile([OPEN, STICKING, SLIDING], 3)
    links = [(0, k) for k in range(1, 10)]
    found = network.opened(contacts(links, status=before), contacts(links, status=after))
    assert np.flatnonzero(found).tolist() == [3, 6]


def test_lattice_directions_do_not_depend_on_the_order_of_partners():
    h = np.sqrt(3.0)
    position = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, h], [-1.0, h]])
    links = [(0, 1), (1, 0), (0, 2), (2, 0), (0, 3), (3, 0)]
    s = state(position, contacts(links))
    expected = [network.HORIZONTAL] * 2 + [network.RISING] * 2 + [network.FALLING] * 2
    assert network.lattice_direction(s).tolist() == expected
    np.testing.assert_allclose(network.contact_angle(s), np.repeat([0.0, np.pi / 3, 2 * np.pi / 3], 2), atol=1e-15)
    tilted = state(position + np.array([[0.0, 1e-17], [0.0, -1e-17], [0.1, 0.0], [0.1, 0.0]]), contacts(links))
    assert network.lattice_direction(tilted).tolist() == expected
    assert np.all((network.contact_angle(tilted) >= 0.0) & (network.contact_angle(tilted) < np.pi))


def test_interior_contacts_by_their_centres():
    position = np.array([[1.0, 1.0], [3.0, 1.0], [5.0, 1.0], [7.0, 1.0]])
    s = state(position, contacts([(0, 1), (1, 2), (3, 2)]))
    assert network.contact_centre(s)[:, 0].tolist() == [2.0, 4.0, 6.0]
    assert network.interior_contacts(s, 8.0, 3.0).tolist() == [False, True, False]
    assert network.interior_contacts(s, 8.0, 2.0).tolist() == [True, True, True]


def test_bulk_disks_keep_all_four_margins():
    position = np.array([[5.0, 5.0], [1.0, 5.0], [9.0, 5.0], [5.0, 1.0], [5.0, 9.0]])
    assert network.bulk_disks(state(position, contacts([])), 10.0, 2.0, 2.0).tolist() == [True, *[False] * 4]


def chain_with_loose_ends():
    """A triangle 0, 1, 2, a tail 2-3-4, and disk 5 alone on the floor; the pair 3-4 is closed, 1-5 open."""
    position = np.array([[1.0, 1.0], [3.0, 1.0], [2.0, 2.7], [4.0, 2.7], [6.0, 2.7], [9.0, 1.0]])
    status = np.array([STICKING] * 5 + [OPEN])
    at_walls = np.array([STICKING] * 3 + [OPEN])
    links, floor = [(0, 1), (1, 2), (0, 2), (2, 3), (3, 4), (1, 5)], [(0, FLOOR), (1, FLOOR), (5, FLOOR), (4, FLOOR)]
    pairs, walls = (contacts(of, 1.0 * (on != OPEN), status=on) for of, on in ((links, status), (floor, at_walls)))
    return state(position, pairs, walls)


def test_rattlers_are_removed_one_after_the_other():
    s = chain_with_loose_ends()
    assert np.flatnonzero(network.rattlers(s)).tolist() == [3, 4, 5]


def test_a_disk_that_touches_another_by_rounding_is_a_rattler_still():
    s = chain_with_loose_ends()
    status, force = np.full(6, STICKING), np.append(np.ones(5), 1e-13)
    touching = replace(s, pairs=replace(s.pairs, status=status, normal_force=force))
    assert np.flatnonzero(network.rattlers(touching)).tolist() == [3, 4, 5]
    bearing = replace(s, pairs=replace(s.pairs, status=status, normal_force=np.ones(6)))
    assert np.flatnonzero(network.rattlers(bearing)).tolist() == [3, 4]


def test_coordination_number_by_definition():
    s = chain_with_loose_ends()
    assert network.coordination_number(s) == pytest.approx(13 / 6)
    assert network.coordination_number(s, walls=False) == pytest.approx(10 / 6)
    assert network.coordination_number(s, without_rattlers=True) == pytest.approx(8 / 3)
    assert network.coordination_number(s, without_rattlers=True, walls=False) == pytest.approx(2.0)
    assert network.coordination_number(s, np.arange(6) == 2) == 3.0


def test_contact_angle_histogram_counts_touching_contacts_only():
    s = slab(4, 6)
    horizontal = network.lattice_direction(s) == network.HORIZONTAL
    _, density = network.contact_angle_histogram(opened(s, ~horizontal), 18)
    assert np.flatnonzero(density).tolist() == [0]
    assert not network.contact_angle_histogram(opened(s, np.ones_like(horizontal)), 18)[1].any()


def test_mirror_of_a_slab():
    s = slab(2, 3)  # disks 0 1 2 below, 3 4 above
    assert network.mirror_disks(s.position, 3.0).tolist() == [2, 1, 0, 4, 3]


test_what_cannot_be_is_named = refusals(
    ValueError,
    (lambda: network.interior_contacts(slab(2, 3), 8.0, 4.0), "margin"),
    (lambda: network.coordination_number(chain_with_loose_ends(), np.arange(6) == 5, without_rattlers=True), "disks"),
    (lambda: network.contact_angle_histogram(slab(4, 6), 0), "bins"),
    (lambda: network.mirror_disks(slab(2, 3).position, 2.5), "no mirror image"),
    (lambda: network.mirror_disks(np.array([[0.0, 0.0], [0.05, 0.0], [10.0, 0.0]]), 5.0), "share"),
)
