
import numpy as np
import pytest
from observe_states import ROW, opened, pair_index, slab, with_pairs

from granular_response.observe.profile import force_profile, row_depth

REST = slab(3, 5)  # 5 + 4 + 5 disks; the middle disk of the top row is 11
TOP = 11


def test_rows_and_the_contacts_between_them_are_told_apart():
    assert REST.position[TOP].tolist() == pytest.approx([5.0, 1.0 + 2 * ROW])
    x, _ = force_profile(REST, REST, TOP, row_depth(1))
    np.testing.assert_allclose(x, [-2.0, 0.0, 2.0], atol=1e-12)
    x, _ = force_profile(REST, REST, TOP, row_depth(1.5))
    np.testing.assert_allclose(x, np.arange(-3.5, 4.0), atol=1e-12)
    x, _ = force_profile(REST, REST, TOP, 0.0)
    np.testing.assert_allclose(x, [-3.0, -1.0, 1.0, 3.0], atol=1e-12)
    assert force_profile(REST, REST, TOP, 20.0)[0].size == 0


def test_magnitude_of_the_vector_difference():
    k = pair_index(REST, 5, 6)  # second row, centre at x = -2
    loaded = with_pairs(REST, k, normal_force=4.0, tangential_force=-4.0)
    x, f = force_profile(REST, loaded, TOP, row_depth(1))
    np.testing.assert_allclose(f, [5.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(x, [-2.0, 0.0, 2.0], atol=1e-12)


def test_contacts_open_in_both_states_are_left_out():
    k = pair_index(REST, 5, 6)
    without = opened(REST, np.array([k]))
    assert force_profile(without, without, TOP, row_depth(1))[0].size == 2
    x, f = force_profile(REST, without, TOP, row_depth(1))
    assert x.size == 3
    assert f[0] == pytest.approx(1.0)  # the load removed the whole force
