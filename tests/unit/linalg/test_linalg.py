"""Banded factorisations and the lowest real eigenvalue, against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from granular_response.linalg import lowest, ordering
from granular_response.linalg.band import Band


def banded(n, b, seed, symmetric=False, dominant=True):
    rng = np.random.default_rng(seed)
    a = np.triu(np.tril(rng.normal(size=(n, n)), b), -b)
    a = a + a.T if symmetric else a
    return a + (4.0 * b + 4.0) * np.eye(n) if dominant else a


def stored(dense, b):
    """A matrix with all entries of its band, those that are zero too."""
    n = len(dense)
    matrix = sp.csc_array((np.abs(np.subtract.outer(np.arange(n), np.arange(n))) <= b).astype(float))
    matrix.data[:] = dense[matrix.indices, np.repeat(np.arange(n), np.diff(matrix.indptr))]
    return matrix


#: Around the four rows that are eliminated at once, the lanes of a vector, and whole numbers of them.
SIZES = [(1, 0), (5, 0), (7, 1), (40, 6), (12, 11), (23, 7), (24, 8), (33, 9), (61, 15), (64, 16), (130, 17), (9, 8)]


@pytest.mark.parametrize(("n", "b"), SIZES)
def test_banded_lu(n, b):
    dense = banded(n, b, 3)
    matrix = stored(dense, b)
    factor = Band(matrix.indptr, matrix.indices).factor(matrix)
    right = np.arange(1.0, n + 1.0)
    assert factor.solve(right) == pytest.approx(np.linalg.solve(dense, right), rel=1e-12)
    assert factor._exchanged is None, "rows were exchanged"
    assert right[-1] == n, "the right-hand side is the caller's"


def test_a_soft_unknown_asks_for_no_row_exchanges():
    """What nothing holds but a tiny stiffness moves far, and the residual is as large as rounding makes it."""
    dense = banded(30, 3, 1)
    dense[20], dense[:, 20] = 0.0, 0.0
    dense[20, 20], dense[19, 20] = 1e-12, 1.0
    matrix = stored(dense, 3)
    factor = Band(matrix.indptr, matrix.indices).factor(matrix)
    right = np.ones(30)
    x = factor.solve(right)
    assert np.abs(x).max() > 1e11 and factor._exchanged is None
    assert x == pytest.approx(np.linalg.solve(dense, right), rel=1e-9)


@pytest.mark.parametrize("soft", [False, True])
@pytest.mark.parametrize("pivot", [1e-2, 1e-5, 1e-8, 1e-11, 1e-14, 0.0])
def test_small_pivots_cost_no_accuracy(pivot, soft):
    """Whether or not another unknown is soft, which a residual of all would not tell apart."""
    dense = banded(30, 3, 1)
    dense[0, 0] = pivot
    if soft:
        dense[20], dense[:, 20] = 0.0, 0.0
        dense[20, 20] = 1e-10
    matrix = stored(dense, 3)
    with np.errstate(all="ignore"):
        x = Band(matrix.indptr, matrix.indices).factor(matrix).solve(np.ones(30))
    assert x == pytest.approx(np.linalg.solve(dense, np.ones(30)), rel=1e-8)


def test_zero_pivot_of_a_symmetric_matrix_does_not_pass_for_positive():
    dense = banded(30, 3, 1, symmetric=True)
    dense[0, 0] = 0.0
    matrix = stored(dense, 3)
    storage = Band(matrix.indptr, matrix.indices)
    assert storage.definite_factor(matrix) is None
    assert storage.negative_eigenvalues(matrix) == 1
    assert storage.factor(matrix).solve(np.ones(30)) == pytest.approx(np.linalg.solve(dense, np.ones(30)), rel=1e-9)


@pytest.mark.parametrize("negative", [0, 1, 4])
def test_number_of_negative_eigenvalues(negative):
    dense = banded(40, 5, 2, symmetric=True)
    values = np.linalg.eigvalsh(dense)
    dense -= (0.5 * (values[negative - 1] + values[negative]) if negative else 0.0) * np.eye(40)
    assert (np.linalg.eigvalsh(dense) < 0).sum() == negative
    matrix = sp.csc_array(dense)
    storage = Band(matrix.indptr, matrix.indices)
    assert storage.negative_eigenvalues(matrix) == negative
    assert storage.factor(matrix).solve(np.ones(40)) == pytest.approx(np.linalg.solve(dense, np.ones(40)), rel=1e-8)


@pytest.mark.parametrize(("n", "b"), [*SIZES, (300, 70)])
def test_definite_factor_solves_and_refuses_what_is_not_definite(n, b):
    dense = banded(n, b, 4, symmetric=True)
    matrix = stored(dense, b)
    storage = Band(matrix.indptr, matrix.indices)
    right = np.arange(1.0, n + 1.0)
    assert storage.definite_factor(matrix).solve(right) == pytest.approx(np.linalg.solve(dense, right), rel=1e-12)
    assert right[-1] == n, "the right-hand side is the caller's"
    matrix.data[matrix.indptr[-1] - 1] -= 2.0 * dense[-1, -1]
    assert storage.definite_factor(matrix) is None
    assert storage.negative_eigenvalues(matrix) == 1


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


def test_a_krylov_space_grows_by_a_fifth_between_two_looks_at_its_eigenvalues(monkeypatch):
    """So hardly farther than it must, with fewer looks than vectors; some dozens of vectors do."""
    values, cost, eig = np.linspace(1.0, 2.0, 400), [0, 0], np.linalg.eig

    def inverse(right):
        cost[0] += 1
        return right / (values - 0.99)

    def looked(matrix):
        cost[1] += 1
        return eig(matrix)

    monkeypatch.setattr(np.linalg, "eig", looked)
    value, _, residual = lowest.nearest(inverse, np.ones(400), 0.99, 1e-9)
    assert value == pytest.approx(1.0, abs=1e-9) and residual <= 1e-9
    assert cost == [18, 11]  # the first space that is large enough has 17


def test_none_is_found_where_vectors_and_points_run_out(monkeypatch):
    matrix = with_eigenvalues((1e-6, *SPREAD), 0)
    assert lowest_of(matrix)[0] is not None
    monkeypatch.setattr(lowest, "OPTIONS", replace(lowest.OPTIONS, most=2))
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


def test_a_large_network_is_dissected_once(monkeypatch):
    monkeypatch.setattr(ordering, "WIDEST_BAND", 0)
    monkeypatch.setattr(ordering, "REMEMBERED", 1)
    rng = np.random.default_rng(1)
    one, other = ((rng.random((n, 2)), np.arange(n - 1), np.arange(1, n)) for n in (40, 55))  # chains
    first, again, new = (ordering.elimination(*asked, 2).dissection for asked in (one, one, other))
    assert first is again and first is not new and len(new.order) == 55
