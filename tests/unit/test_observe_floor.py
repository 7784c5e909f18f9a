
import numpy as np
import pytest
from observe_states import contacts, state

from granular_response.observe.floor import floor_disks, floor_force, floor_response, interior_mask, smoothed_response
from granular_response.state import FLOOR, LEFT_WALL, OPEN, RIGHT_WALL, STICKING


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


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: floor_disks([]), "states"),
        *(
            (lambda force=force: floor_response(three_disks(), three_disks(), np.array([0]), force), "total_force")
            for force in (0.0, -1.0, np.nan, np.inf)
        ),
        (lambda: smoothed_response([0.0], [0.0], [1.0], 0.0), "width"),
        (lambda: interior_mask(np.array([5.0]), 20.0, 10.0), "margin"),
    ],
)
def test_what_cannot_be_is_named(call, named):
    with pytest.raises(ValueError, match=named):
        call()
