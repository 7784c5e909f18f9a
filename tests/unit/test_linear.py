"""Banded factorisations against numpy's dense ones."""

import numpy as np
import pytest
import scipy.sparse as sp

from granular_response.solve.linear import band_lu
from granular_response.solve.linear.band import Band
from granular_response.solve.linear.ordering import node_order


def banded(n, b, seed, symmetric=False, dominant=True):
    rng = np.random.default_rng(seed)
    a = np.triu(np.tril(rng.normal(size=(n, n)), b), -b)
    a = a + a.T if symmetric else a
    return a + (4.0 * b + 4.0) * np.eye(n) if dominant else a


def by_rows(dense, b):
    """The band of a matrix as the kernels store it."""
    n = len(dense)
    stored = np.zeros((n, 2 * b + 1))
    for i in range(n):
        for j in range(max(0, i - b), min(n, i + b + 1)):
            stored[i, j - i + b] = dense[i, j]
    return stored


@pytest.mark.parametrize(("n", "b"), [(1, 0), (5, 0), (7, 1), (40, 6), (12, 11)])
def test_banded_lu(n, b):
    dense = banded(n, b, 3)
    stored = by_rows(dense, b)
    band_lu.factorise(stored.ravel(), len(stored), b)
    x = np.arange(1.0, n + 1.0)
    band_lu.solve(stored.ravel(), len(stored), b, x)
    assert x == pytest.approx(np.linalg.solve(dense, np.arange(1.0, n + 1.0)), rel=1e-12)


@pytest.mark.parametrize(("n", "b"), [(3, 2), (9, 4), (23, 5), (24, 7), (10, 9)])
def test_four_rows_at_once_give_the_bits_of_one_by_one(n, b):
    dense = banded(n, b, 5)
    stored = by_rows(dense, b)
    band_lu.factorise(stored.ravel(), len(stored), b)
    for k in range(n):
        for i in range(k + 1, min(n, k + b + 1)):
            dense[i, k] *= 1.0 / dense[k, k]
            dense[i, k + 1 : k + b + 1] -= dense[i, k] * dense[k, k + 1 : k + b + 1]
    for i in range(n):
        for j in range(max(0, i - b), min(n, i + b + 1)):
            assert stored[i, j - i + b] == dense[i, j]


def test_zero_pivot_falls_back_to_row_exchanges():
    dense = banded(30, 3, 1)
    dense[0, 0] = 0.0
    matrix = sp.csc_array(np.where(np.abs(np.subtract.outer(np.arange(30), np.arange(30))) <= 3, dense, 0.0))
    full = sp.csc_array(np.abs(np.subtract.outer(np.arange(30), np.arange(30))) <= 3).astype(float)
    full.data[:] = matrix.toarray()[full.indices, np.repeat(np.arange(30), np.diff(full.indptr))]
    right = np.ones(30)
    with np.errstate(all="ignore"):
        x = Band(full.indptr, full.indices).factor(full).solve(right)
    assert x == pytest.approx(np.linalg.solve(dense, right), rel=1e-9)


@pytest.mark.parametrize("negative", [0, 1, 4])
def test_number_of_negative_eigenvalues(negative):
    dense = banded(40, 5, 2, symmetric=True)
    values = np.linalg.eigvalsh(dense)
    dense -= (0.5 * (values[negative - 1] + values[negative]) if negative else 0.0) * np.eye(40)
    assert (np.linalg.eigvalsh(dense) < 0).sum() == negative
    matrix = sp.csc_array(dense)
    factor, found = Band(matrix.indptr, matrix.indices).symmetric_factor(matrix)
    assert found == negative
    assert factor.solve(np.ones(40)) == pytest.approx(np.linalg.solve(dense, np.ones(40)), rel=1e-8)


@pytest.mark.parametrize(("n", "b"), [(1, 0), (5, 0), (7, 1), (40, 6), (12, 11), (300, 70)])
def test_definite_factor_solves_and_refuses_what_is_not_definite(n, b):
    dense = banded(n, b, 4, symmetric=True)
    matrix = sp.csc_array(np.where(np.abs(np.subtract.outer(np.arange(n), np.arange(n))) <= b, dense, 0.0))
    storage = Band(matrix.indptr, matrix.indices)
    right = np.arange(1.0, n + 1.0)
    assert storage.definite_factor(matrix).solve(right) == pytest.approx(np.linalg.solve(dense, right), rel=1e-12)
    assert right[-1] == n, "the right-hand side is the caller's"
    matrix.data[matrix.indptr[-1] - 1] -= 2.0 * dense[-1, -1]
    assert storage.definite_factor(matrix) is None
    assert storage.symmetric_factor(matrix)[1] == 1


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
