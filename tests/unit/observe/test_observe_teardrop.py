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


DROP, SLANTED = [(5, 0), (4, -1), (4, 1), (3, -2), (3, 0), (3, 2)], [(5, 0), (4, 1), (4, 3), (3, 4)]
APART, DOWN = [(1, 0), (3, 8), (0, -3)], [(5, 0), (4, 1), (3, 0), (2, 1), (1, 0)]
#: Opened contacts (row, x) of the region and beside it, depth in rows, width, and whether it is at the floor.
REGIONS = {
    "nearest to the load": (DROP, APART, (3, 6.0, False)),
    "as wide as its widest row": (SLANTED, [], (3, 4.0, False)),
    "down to the row above the floor": (DOWN, [], (5, 2.0, False)),
    "down to the floor": ([*DOWN, (0, 1)], [], (6, 2.0, True)),
    "without four aside and two rows down": ([(5, 0)], [(5, 4), (3, 0)], (1, 2.0, False)),
    "not more than five lattice constants, 10, away": ([], [(4, -11), (4, 11)], (0, 0.0, False)),
    "9.6 away": ([(4, -9), (4, 9)], [], (2, 20.0, False)),
}


@pytest.mark.parametrize(("region", "apart", "expected"), REGIONS.values(), ids=REGIONS)
def test_region_is_the_component_nearest_to_the_load(region, apart, expected):
    inside, beside = ([p for row, x in places for p in row_pairs(row, x)] for places in (region, apart))
    found = teardrop(REST, opened(REST, inside + beside), TOP)
    assert np.flatnonzero(found.contacts).tolist() == sorted(inside) and found.count == len(inside)
    rows, width, at_floor = expected
    assert (found.depth, found.width) == pytest.approx((rows * ROW, width)) and found.reaches_floor == at_floor
    # an oblique contact has one floor disk only
    oblique = pair_index(REST, 10, LONG + 10)
    assert at_floor or not teardrop(REST, opened(REST, [*inside, *beside, oblique]), TOP).reaches_floor


def test_equally_near_contacts_begin_the_region_together():
    pair = row_pairs(5, -2.0, 2.0)
    moved = REST.position.copy()
    moved[REST.pairs.first[pair[0]]] += 1e-4
    uneven = replace(REST, position=moved)
    assert teardrop(uneven, opened(uneven, pair), TOP).count == 2
    assert np.flatnonzero(teardrop(REST, opened(REST, pair), TOP).contacts).tolist() == sorted(pair)


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
