from dataclasses import replace

import numpy as np
import pytest
from observe_states import ROW, opened, pair_index, slab

from granular_response.observe import network
from granular_response.observe.network import interior_contacts
from granular_response.observe.teardrop import open_region

LAYERS, LONG = 7, 21
WIDTH = 2.0 * LONG
REST = slab(LAYERS, LONG)
TOP = int(np.argmin(np.linalg.norm(REST.position - [LONG, 1.0 + 6 * ROW], axis=1)))


def row_pairs(row, *middles):
    """Horizontal pairs of a row (0 at the bottom) whose centres are ``middles`` off the axis of the slab."""
    centre = 0.5 * (REST.position[REST.pairs.first] + REST.position[REST.pairs.second])
    found = []
    for x in middles:
        hit = np.flatnonzero(np.linalg.norm(centre - [LONG + x, 1.0 + row * ROW], axis=1) < 1e-9)
        assert hit.size == 1
        found.append(int(hit[0]))
    return found


def teardrop(rest, loaded, disk, **options):
    """The region that opens below ``disk``."""
    return open_region(rest, network.opened(rest.pairs, loaded.pairs), rest.position[disk], **options)


def test_region_is_the_component_nearest_to_the_load():
    drop = row_pairs(5, 0.0) + row_pairs(4, -1.0, 1.0) + row_pairs(3, -2.0, 0.0, 2.0)
    apart = row_pairs(1, 0.0) + row_pairs(3, 8.0) + row_pairs(0, -3.0)
    region = teardrop(REST, opened(REST, drop + apart), TOP)
    assert np.flatnonzero(region.contacts).tolist() == sorted(drop)
    assert region.count == 6
    assert region.depth == pytest.approx(3 * ROW)
    assert region.width == pytest.approx(6.0)
    assert not region.reaches_floor


def test_width_is_that_of_the_widest_row_not_of_the_whole_region():
    slanted = row_pairs(5, 0.0) + row_pairs(4, 1.0, 3.0) + row_pairs(3, 4.0)
    region = teardrop(REST, opened(REST, slanted), TOP)
    assert region.count == 4
    assert region.width == pytest.approx(4.0)


def test_second_neighbours_are_not_adjacent():
    # Two rows down on the axis is 3.46 away, four aside in one row is 4 away.
    region = teardrop(REST, opened(REST, row_pairs(5, 0.0, 4.0) + row_pairs(3, 0.0)), TOP)
    assert region.count == 1


def test_equally_near_contacts_begin_the_region_together():
    pair = row_pairs(5, -2.0, 2.0)
    moved = REST.position.copy()
    moved[REST.pairs.first[pair[0]]] += 1e-4
    uneven = replace(REST, position=moved)
    assert teardrop(uneven, opened(uneven, pair), TOP).count == 2
    assert np.flatnonzero(teardrop(REST, opened(REST, pair), TOP).contacts).tolist() == sorted(pair)


def test_region_reaches_the_floor_with_a_contact_of_two_floor_disks():
    to_row_one = [p for row, x in ((5, 0.0), (4, 1.0), (3, 0.0), (2, 1.0), (1, 0.0)) for p in row_pairs(row, x)]
    short = teardrop(REST, opened(REST, to_row_one), TOP)
    assert short.depth == pytest.approx(5 * ROW)
    assert not short.reaches_floor
    full = teardrop(REST, opened(REST, to_row_one + row_pairs(0, 1.0)), TOP)
    assert full.depth == pytest.approx(6 * ROW)
    assert full.reaches_floor
    # An oblique contact has one floor disk only.
    bottom, above = 10, LONG + 10
    oblique = pair_index(REST, bottom, above)
    assert not teardrop(REST, opened(REST, [*to_row_one, oblique]), TOP).reaches_floor


def test_contacts_far_from_the_load_are_not_a_teardrop():
    both_sides = opened(REST, row_pairs(4, -11.0, 11.0))
    assert teardrop(REST, both_sides, TOP).count == 0
    assert teardrop(REST, opened(REST, row_pairs(4, -9.0, 9.0)), TOP).count == 2  # 9.6 away, 5 lattice constants are 10


def test_start_narrows_where_the_region_begins():
    aside, near = row_pairs(6, -9.0), row_pairs(3, 0.0)
    start = interior_contacts(REST, WIDTH, 15.0)
    assert teardrop(REST, opened(REST, aside), TOP).count == 1
    assert teardrop(REST, opened(REST, aside), TOP, start=start).count == 0
    off_axis = np.abs(0.5 * (REST.position[REST.pairs.first] + REST.position[REST.pairs.second])[:, 0] - LONG) > 0.5
    region = teardrop(REST, opened(REST, near + row_pairs(2, 5.0)), TOP, start=off_axis)
    assert np.flatnonzero(region.contacts).tolist() == row_pairs(2, 5.0)


def test_contacts_open_at_rest_do_not_count():
    gap = row_pairs(5, 0.0)
    rest = opened(REST, gap)
    assert teardrop(rest, opened(rest, row_pairs(4, 1.0)), TOP).count == 1
    assert teardrop(rest, rest, TOP).count == 0
