"""Close pairs against brute force, and runs as a lossless form of a pair list."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from granular_response.kernels.neighbours import make_runs, run_pairs
from granular_response.solvers.close_pairs import close_pairs


def brute_force(position, radius, skin):
    n = len(radius)
    return [
        (i, j)
        for i in range(n)
        for j in range(i + 1, n)
        if np.hypot(*(position[i] - position[j])) < radius[i] + radius[j] + skin
    ]


@pytest.mark.parametrize("skin", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("seed", range(4))
def test_close_pairs(seed, skin):
    rng = np.random.default_rng(seed)
    n = 150
    # negative coordinates, a far outlier and crowded spots
    position = np.concatenate([rng.normal(0, 1.5, (n // 2, 2)), rng.uniform(-20, 20, (n // 2 - 1, 2)), [[300.0, 90.0]]])
    radius = rng.uniform(0.3, 1.3, len(position))
    first, second = close_pairs(position, radius, skin)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == brute_force(position, radius, skin)


def test_one_disk_has_no_pairs():
    first, second = close_pairs(np.array([[1.0, 1.0]]), np.ones(1), 0.5)
    assert len(first) == len(second) == 0
    runs, slot = make_runs(first, second, 1)
    assert runs.shape == (0, 4) and len(slot) == 0
    assert [len(part) for part in run_pairs(runs)] == [0, 0]


@given(
    pairs=st.sets(st.tuples(st.integers(0, 60), st.integers(1, 6)), max_size=150),
    multiple=st.sampled_from([1, 2, 8]),
)
def test_lengthened_runs_hold_every_pair_in_a_slot_of_its_own(pairs, multiple):
    listed = np.array(sorted((i, i + d) for i, d in pairs), np.int64).reshape(-1, 2)
    n = int(listed.max(initial=0)) + 1
    runs, slot = make_runs(listed[:, 0], listed[:, 1], n, shortest_run=4, multiple=multiple)
    first, second = run_pairs(runs)
    assert np.array_equal(first[slot], listed[:, 0]) and np.array_equal(second[slot], listed[:, 1])
    assert len(np.unique(slot)) == len(slot)
    assert first.min(initial=0) >= 0 and second.max(initial=0) < n
    i, j, count, _ = runs.T
    long = count > 1
    room = n - j - count + i
    assert np.all((count % multiple == 0) | (room < -count % multiple) | ~long)


@pytest.mark.parametrize("far", [1e6, 1e300])
def test_disks_far_apart_need_no_more_room(far):
    position = np.array([[0.0, 1.0], [1.9, 1.0], [0.9 * far, far], [0.9 * far, 0.0]])
    first, second = close_pairs(position, np.ones(4), 0.5)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == [(0, 1)]
