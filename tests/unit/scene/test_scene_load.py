"""Which disk a load acts on."""

import numpy as np
import pytest
from refusals import refuses

from granular_response.scene import (
    Packing,
    PilePacking,
    PouredPacking,
    RowSelector,
    Scene,
    SceneError,
    SlabPacking,
    TopSelector,
    resolve_disk,
)
from granular_response.solvers.problem import Problem


def scattered(position, radius, width):
    position, radius = np.array(position, float), np.array(radius, float)
    return Packing(position, radius, np.full(len(radius), -1, np.int32), width)


def test_top_centre_of_lattices():
    slab = SlabPacking().build()
    assert resolve_disk("top-centre", slab, slab.position) == 877
    assert tuple(slab.position[877]) == pytest.approx((61.0, 1.0 + 14.0 * np.sqrt(3.0)))
    pile = PilePacking().build()
    assert resolve_disk("top-centre", pile, pile.position) == 175
    # A short row at the top has two disks equally near to the middle: the left one.
    even = SlabPacking(layers=4, disks_per_row=7).build()
    chosen = resolve_disk("top-centre", even, even.position)
    assert even.row[chosen] == 3
    assert even.position[chosen, 0] == pytest.approx(6.0)


@pytest.mark.parametrize("layers", [3, 4])
def test_top_centre_withstands_small_shifts(layers):
    """Disks whose upper neighbours have moved apart are not on top, and rounding errors do not choose."""
    packing = SlabPacking(layers=layers, disks_per_row=7).build()
    top = packing.row.max()
    middle = resolve_disk("top-centre", packing, packing.position)
    for seed in range(20):
        noise = np.random.default_rng(seed).normal(size=packing.position.shape)
        assert packing.row[resolve_disk("top-centre", packing, packing.position + 0.02 * noise)] == top
        assert resolve_disk("top-centre", packing, packing.position + 1e-9 * noise) == middle


def test_top_centre_is_not_covered():
    # A loose disk rests in the notch above disks 1 and 2, and is nearest to the middle.
    floor = [(1.0, 1.0), (3.0, 1.0), (5.0, 1.0), (7.0, 1.0)]
    loose = [*floor, (4.0, 1.0 + np.sqrt(3.0))]
    assert resolve_disk("top-centre", scattered(loose, np.ones(5), 8.0), np.array(loose)) == 4
    # Without it disks 1 and 2 are equally near, also if the other is a little nearer or their order is reversed.
    four = scattered(floor, np.ones(4), 8.0)
    assert resolve_disk("top-centre", four, np.array(floor)) == 1
    assert resolve_disk("top-centre", four, np.array(floor) - [1e-9, 0.0]) == 1
    assert resolve_disk("top-centre", four, np.array(floor[::-1])) == 1
    assert resolve_disk("top-centre", four, np.array(floor) - [1e-3, 0.0]) == 2
    # A disk high above the middle of the box covers only what it is above.
    high = [*floor, (3.2, 9.0)]
    assert resolve_disk("top-centre", scattered(high, np.ones(5), 8.0), np.array(high)) == 4


def test_index_and_row():
    packing = SlabPacking(layers=4, disks_per_row=7).build()  # rows 0-6, 7-12, 13-19, 20-25
    position = packing.position
    assert resolve_disk(0, packing, position) == 0
    assert resolve_disk(25, packing, position) == 25
    assert resolve_disk(RowSelector(row="bottom"), packing, position) == 3
    assert resolve_disk(RowSelector(row="bottom", offset=3), packing, position) == 6
    assert resolve_disk(RowSelector(row=2, offset=-3), packing, position) == 13
    assert resolve_disk(RowSelector(row="top"), packing, position) == 22
    assert resolve_disk(RowSelector(row="top", offset=-2), packing, position) == 20
    assert resolve_disk(RowSelector(row="top", offset=3), packing, position) == 25


def test_a_place_means_the_disk_on_top_nearest_to_it():
    """In any packing; x counts from the middle, where top-centre is."""
    slab = SlabPacking(layers=4, disks_per_row=7).build()  # the top row is at x = 2, 4, ..., 12 of 14
    chosen = [resolve_disk(TopSelector(x=x), slab, slab.position) for x in (-7.0, -5.0, -1.2, 0.0, 1.2, 3.9, 7.0)]
    assert chosen == [20, 20, 22, 22, 23, 24, 25]
    assert resolve_disk(TopSelector(x=0.0), slab, slab.position) == resolve_disk("top-centre", slab, slab.position)
    loose = scattered([(1.0, 1.0), (3.0, 1.0), (2.0, 2.7), (9.0, 1.0)], np.ones(4), 10.0)
    assert [resolve_disk(TopSelector(x=x), loose, loose.position) for x in (-4.0, -1.0, 4.0)] == [2, 2, 3]


def test_a_place_is_found_across_periodic_sides():
    slab = SlabPacking(layers=3, disks_per_row=8, sides="periodic").build()  # 16 wide
    middle = resolve_disk("top-centre", slab, slab.position)
    half = [resolve_disk(TopSelector(x=x), slab, slab.position) for x in (-8.0, 8.0)]
    assert half[0] == half[1] != middle
    far = slab.position[half[0], 0] - slab.position[middle, 0]
    assert abs(far) == pytest.approx(8.0)


def test_a_place_beyond_the_sides_says_which_load():
    problem = Problem.from_scene(
        Scene.from_text("loads: [{disk: 0, force: [0, 0]}, {disk: {x: 99.0}, force: [0, -1]}]")
    )
    with pytest.raises(
        SceneError, match=r"^loads\[1\]\.disk\.x = 99\.0: must be from -61 to 61, the packing is 122 wide$"
    ):
        problem.with_loads(problem.packing.position)


@pytest.mark.parametrize(
    ("selector", "message"),
    [
        (26, "disk = 26: must be from 0 to 25, the packing has 26 disks"),
        (-1, "disk = -1: must be from 0 to 25, the packing has 26 disks"),
        (RowSelector(row=4), "disk.row = 4: must be top, bottom or from 0 to 3, the packing has 4 rows"),
        (RowSelector(row="top", offset=-3), "disk.offset = -3: must be from -2 to 3, row 3 has 6 disks"),
        (TopSelector(x=7.5), "disk.x = 7.5: must be from -7 to 7, the packing is 14 wide"),
        ("top", "disk = 'top': must be top-centre, the index of a disk, a TopSelector or a RowSelector"),
    ],
)
def test_missing_disks(selector, message):
    packing = SlabPacking(layers=4, disks_per_row=7).build()
    assert refuses(SceneError, None, resolve_disk, selector, packing, packing.position) == message


def test_only_lattices_have_rows():
    packing = PouredPacking(disks=5, width=10.0).build()
    with pytest.raises(
        SceneError, match=r"^disk\.row = 'top': only slabs and piles have rows, must be top-centre, {x: "
    ):
        resolve_disk(RowSelector(row="top"), packing, packing.position)


def test_a_torque_alone_is_a_load():
    (load,) = Scene.from_text("loads: [{disk: 17, torque: 4}]").loads
    assert (load.force, load.torque) == ((0.0, 0.0), 4.0)


def test_sideways_forces_that_sum_to_zero_but_for_rounding_are_allowed():
    loads = [{"disk": k, "force": [force, 0.0]} for k, force in ((3, 0.1), (4, 0.2), (5, -0.3))]
    assert sum(load["force"][0] for load in loads) != 0.0
    Scene().updated({"packing.sides": "periodic", "loads": loads})
    loads[0]["force"] = [0.1001, 0.0]
    Scene().updated({"packing.sides": "periodic", "loads": loads, "wall.friction": 0.3})
    with pytest.raises(SceneError, match="sum of the forces along x, must be 0 with periodic sides on a smooth floor"):
        Scene().updated({"packing.sides": "periodic", "loads": loads})
