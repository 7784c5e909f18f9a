"""Positions, radii and neighbours of slabs and piles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from granular_response.scene import PilePacking, SlabPacking

ROOT3 = np.sqrt(3.0)

slabs = st.builds(
    SlabPacking,
    layers=st.integers(1, 8),
    disks_per_row=st.integers(2, 9),
    lattice_constant=st.sampled_from([1.5, 2.0, 2.3, "touching-largest"]),
    polydispersity=st.sampled_from([0.0, 0.01, 0.5]),
    seed=st.integers(0, 5),
)
piles = st.builds(PilePacking, layers=st.integers(1, 7), polydispersity=st.sampled_from([0.0, 0.1]))


def test_slab_of_the_paper():
    packing = SlabPacking().build()
    assert packing.n == 8 * 61 + 7 * 60 == 908
    assert packing.width == 122.0
    assert packing.position.flags.c_contiguous and packing.position.dtype == np.float64
    assert packing.row.dtype == np.int32
    assert list(packing.row_count) == [61, 60] * 7 + [61]
    assert tuple(packing.position[0]) == (1.0, 1.0)
    assert tuple(packing.position[60]) == (121.0, 1.0)
    assert tuple(packing.position[61]) == pytest.approx((2.0, 1.0 + ROOT3))
    assert tuple(packing.position[-1]) == pytest.approx((121.0, 1.0 + 14.0 * ROOT3))
    assert (packing.radius == 1.0).all() and (packing.mass == 1.0).all() and (packing.inertia == 0.5).all()


def test_pile_of_the_paper():
    packing = PilePacking().build()
    assert list(packing.row_count) == [31, 28, 25, 22, 19, 16, 13, 10, 7, 4, 1]
    assert packing.width == 62.0
    x, z = packing.position.T
    assert tuple(packing.position[-1]) == pytest.approx((31.0, 1.0 + 10.0 * ROOT3))
    # Symmetric, and the ends of the rows lie on lines at 30 degrees.
    assert np.allclose(np.sort(62.0 - x), np.sort(x))
    ends = packing.position[np.concatenate([[0], np.cumsum(packing.row_count)[:-1]])]
    slope = np.diff(ends[:, 1]) / np.diff(ends[:, 0])
    assert np.allclose(np.degrees(np.arctan(slope)), 30.0)
    assert z.min() == 1.0


@given(slabs | piles)
def test_neighbours_are_those_at_one_lattice_constant(described):
    packing = described.build()
    offset = packing.position[:, None] - packing.position[None, :]
    near = np.hypot(offset[..., 0], offset[..., 1]) < 1.3 * packing.lattice_constant
    expected = np.argwhere(np.triu(near, 1))
    pairs = packing.neighbour_pairs()
    assert pairs.dtype == np.int32 and pairs.shape == expected.shape
    assert (pairs == expected).all()


@given(slabs | piles)
def test_box_is_tangent_to_the_lattice(described):
    packing = described.build()
    half = 0.5 * packing.lattice_constant
    bottom = packing.position[packing.row == 0]
    assert bottom[0] == pytest.approx((half, half))
    assert bottom[-1] == pytest.approx((packing.width - half, half))
    assert packing.position[:, 0].min() == pytest.approx(half)
    assert packing.position[:, 0].max() == pytest.approx(packing.width - half)
    # Numbered row by row from the bottom, left to right.
    assert (np.diff(packing.row) >= 0).all()
    assert (np.diff(packing.position[:, 0])[np.diff(packing.row) == 0] > 0).all()


@pytest.mark.parametrize("delta", [0.01, 0.1, 0.25, 0.9])
def test_radii_have_mean_one_and_the_right_spread(delta):
    radius = SlabPacking(layers=40, disks_per_row=100, polydispersity=delta).build().radius
    assert radius.mean() == pytest.approx(1.0, abs=1e-15)
    mean = 1.0 - 0.5 * delta  # of the interval [1 - delta, 1], to which the radii are proportional
    assert radius.max() == pytest.approx(1.0 / mean, rel=0.02 * delta / mean)
    assert radius.min() == pytest.approx((1.0 - delta) / mean, rel=0.02 * delta / (1.0 - delta))
    assert radius.std() == pytest.approx(delta / np.sqrt(12.0) / mean, rel=0.03)


def test_mass_is_area():
    packing = SlabPacking(layers=5, disks_per_row=9, polydispersity=0.5).build()
    assert packing.mass.mean() == pytest.approx(1.0, abs=1e-15)
    assert np.allclose(packing.mass / packing.mass[0], (packing.radius / packing.radius[0]) ** 2)
    assert np.allclose(packing.inertia, 0.5 * packing.mass * packing.radius**2)


def test_a_realization_is_seed_and_number():
    def radius(delta=0.1, **drawn):
        return SlabPacking(layers=5, disks_per_row=9, polydispersity=delta, **drawn).build().radius

    assert (radius() == radius()).all()
    assert not np.allclose(radius(), radius(seed=1))
    assert not np.allclose(radius(), radius(realization=1))
    assert not np.allclose(radius(seed=1), radius(realization=1))

    def drawn(delta):  # the random numbers behind the radii, but for a factor and a shift
        r = radius(delta)
        return (r - r.min()) / (r.max() - r.min())

    assert np.allclose(drawn(0.01), drawn(0.25), atol=1e-10)
    # Fixed values, so that a change of the random numbers does not go unseen.
    assert radius()[:3] == pytest.approx([0.9547492701, 1.0208022844, 0.9780032647], abs=1e-9)


def test_touching_largest_leaves_no_large_overlap():
    for delta in (0.01, 0.25):
        packing = SlabPacking(polydispersity=delta, lattice_constant="touching-largest").build()
        pairs = packing.neighbour_pairs()
        overlap = packing.radius[pairs].sum(axis=1) - packing.lattice_constant
        # The largest disks are a little larger where the mean of the sample is below that of the interval.
        assert overlap.max() < 0.03 * delta
        crowded = SlabPacking(polydispersity=delta).build()
        assert (crowded.radius[pairs].sum(axis=1) - 2.0).max() > 0.5 * delta
        floor = packing.radius[packing.row == 0] - packing.position[packing.row == 0, 1]
        assert floor.max() < 0.02 * delta
