"""Banded factorisations against numpy's dense ones."""

import numpy as np
import pytest
import scipy.sparse as sp

from granular_response.linalg.band import Band
from granular_response.linalg.band_lu import rounded
from granular_response.linalg.ordering import node_order


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


@pytest.mark.parametrize(("n", "b"), SIZES)
def test_rows_hold_the_factors_and_zeros_beyond_the_band(n, b):
    dense = banded(n, b, 5)
    matrix = stored(dense, b)
    rows, wide = Band(matrix.indptr, matrix.indices).factor(matrix)._rows, rounded(b)
    lower, upper, outside = np.eye(n), np.zeros((n, n)), rows.copy()
    for i in range(n):
        for j in range(max(0, i - b), min(n, i + b + 1)):
            (upper if j >= i else lower)[i, j] = rows[i, wide + j - i]
            outside[i, wide + j - i] = 0.0
    assert lower @ upper == pytest.approx(dense, rel=1e-13, abs=1e-13 * b)
    assert not outside.any()


def test_zero_pivot_falls_back_to_row_exchanges():
    dense = banded(30, 3, 1)
    dense[0, 0] = 0.0
    matrix = stored(dense, 3)
    right = np.ones(30)
    with np.errstate(all="ignore"):
        x = Band(matrix.indptr, matrix.indices).factor(matrix).solve(right)
    assert x == pytest.approx(np.linalg.solve(dense, right), rel=1e-9)


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
@pytest.mark.parametrize("pivot", [1e-2, 1e-5, 1e-8, 1e-11, 1e-14])
def test_small_pivots_cost_no_accuracy(pivot, soft):
    """Whether or not another unknown is soft, which a residual of all would not tell apart."""
    dense = banded(30, 3, 1)
    dense[0, 0] = pivot
    if soft:
        dense[20], dense[:, 20] = 0.0, 0.0
        dense[20, 20] = 1e-10
    matrix = stored(dense, 3)
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


def test_node_order_is_a_permutation_that_keeps_neighbours_close():
    x, z = np.meshgrid(np.arange(30.0), np.arange(5.0))
    position = np.stack([x.ravel(), z.ravel()], axis=1)
    index = np.arange(150).reshape(5, 30)
    first = np.concatenate([index[:, :-1].ravel(), index[:-1].ravel()])
    second = np.concatenate([index[:, 1:].ravel(), index[1:].ravel()])
    order = node_order(position, first, second)
    assert sorted(order.tolist()) == list(range(150))
    place = np.argsort(order)
    assert np.abs(place[first] - place[second]).max() <= 6
