"""The lowest real eigenvalue of unsymmetric matrices, against all eigenvalues of dense ones."""

from dataclasses import replace

import numpy as np
import pytest

from granular_response.linalg import lowest

LEFT = -100.0


def lowest_of(matrix):
    """What is found, and the number of solutions and points that it took."""
    n = len(matrix)
    cost = [0, 0]

    def inverse(point):
        inverted = np.linalg.inv(matrix - point * np.eye(n))
        cost[1] += 1

        def solve(right):
            cost[0] += 1
            return inverted @ right

        return solve

    return lowest.lowest_real(inverse, n, LEFT), *cost


def with_eigenvalues(values, seed):
    """A real matrix with these eigenvalues, in an oblique basis; a complex one stands for a pair."""
    blocks = [np.array([[v.real, v.imag], [-v.imag, v.real]]) if v.imag else np.array([[v.real]]) for v in values]
    n = sum(map(len, blocks))
    matrix, at = np.zeros((n, n)), 0
    for block in blocks:
        matrix[at : at + len(block), at : at + len(block)] = block
        at += len(block)
    basis = np.eye(n) + np.random.default_rng(seed).normal(0.0, 0.3 / np.sqrt(n), (n, n))
    return basis @ matrix @ np.linalg.inv(basis)


SPREAD = tuple(complex(v) for v in np.geomspace(3.0, 3e3, 40))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "values, expected",
    [
        ((), None),
        ((1e-6, 1.000001e-6, 1e-6), None),  # disks that roll freely
        ((-7.0,), -7.0),
        ((-1.0, 1e-6, 1e-6), -1.0),
        ((-5.0, -0.3, -4.9), -5.0),
        ((-2e-6, 1e-6), -2e-6),
        ((-3.0 + 0.5j, -1.0 + 8.0j, 1e-6), None),  # oscillations
        ((-3.0 + 0.5j, -1.0, 1e-6), -1.0),  # beyond one
    ],
)
def test_the_lowest_is_found_where_it_is_negative(values, expected, seed):
    matrix = with_eigenvalues((*(complex(v) for v in values), *SPREAD), seed)
    (value, vector), solutions, points = lowest_of(matrix)
    if expected is None:
        assert value >= 0.0
    else:
        assert value == pytest.approx(expected, rel=1e-6)
        assert np.abs(matrix @ vector - value * vector).max() < 1e-6 * np.abs(vector).max()
    assert solutions < 120 and points < 20  # that of a slab is decided within 40


def test_none_is_found_where_points_run_out(monkeypatch):
    matrix = with_eigenvalues((1e-6, *SPREAD), 0)
    assert lowest_of(matrix)[0] is not None
    monkeypatch.setattr(lowest, "OPTIONS", replace(lowest.OPTIONS, points=2))
    assert lowest_of(matrix)[0] is None


def test_a_negative_eigenvalue_is_followed_to_a_matrix_nearby_and_no_farther_than_zero():
    matrix = with_eigenvalues((complex(-7.0), *SPREAD), 0)
    (value, vector), *_ = lowest_of(matrix)

    def inverse(changed):
        return lambda point: lambda right: np.linalg.solve(changed - point * np.eye(len(matrix)), right)

    nearby = matrix + 1e-3 * np.random.default_rng(1).normal(size=matrix.shape)
    found, direction = lowest.followed(inverse(nearby), (value, vector))
    assert found == pytest.approx(np.linalg.eigvals(nearby).real.min(), rel=1e-9)
    assert nearby @ direction == pytest.approx(found * direction, abs=1e-6)
    assert lowest.followed(inverse(matrix + 8.0 * np.eye(len(matrix))), (value, vector)) is None
