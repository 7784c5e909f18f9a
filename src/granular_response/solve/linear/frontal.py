"""Gathering of the fronts of a multifrontal factorisation (see ``solve.linear.multifrontal``).

A front is a dense matrix over the unknowns ``start ... stop`` that it eliminates and the boundary, the later unknowns
that these are tied to; its blocks are ``f11`` (own, own), ``f21`` (boundary, own), ``f12`` and ``f22``. All are
stored by columns. Matrices with lower triangles only are symmetric.
"""

from __future__ import annotations

from ...machine.machine_code import kernel


@kernel
def add_columns(data, indices, indptr, start, stop, boundary, place, f11, f21):
    """Add the columns ``start ... stop`` of a column-compressed matrix, rows from ``start`` on.

    ``boundary`` : (b,) sorted unknowns of the boundary; ``place`` : (n,) room for their places.
    """
    for b in range(boundary.size):
        place[boundary[b]] = b
    for column in range(start, stop):
        for k in range(indptr[column], indptr[column + 1]):
            row = indices[k]
            if row >= stop:
                f21[place[row], column - start] += data[k]
            elif row >= start:
                f11[row - start, column - start] += data[k]


@kernel
def add_rows(data, indices, indptr, start, stop, place, f12):
    """Add the rows ``start ... stop`` of a row-compressed matrix, columns from ``stop`` on, after ``add_columns``."""
    for row in range(start, stop):
        for k in range(indptr[row], indptr[row + 1]):
            if indices[k] >= stop:
                f12[row - start, place[indices[k]]] += data[k]


@kernel
def add_child(update, index, own, f11, f21, f12, f22):
    """Add what an earlier front has left for its boundary; ``index`` : (c,) sorted places in this front."""
    split = 0
    while split < index.size and index[split] < own:
        split += 1
    for j in range(split):
        column = index[j]
        for i in range(split):
            f11[index[i], column] += update[i, j]
        for i in range(split, index.size):
            f21[index[i] - own, column] += update[i, j]
    for j in range(split, index.size):
        column = index[j] - own
        for i in range(split):
            f12[index[i], column] += update[i, j]
        for i in range(split, index.size):
            f22[index[i] - own, column] += update[i, j]


@kernel
def add_child_symmetric(update, index, own, f11, f21, f22):
    """As :func:`add_child` with lower triangles only."""
    split = 0
    while split < index.size and index[split] < own:
        split += 1
    for j in range(split):
        column = index[j]
        for i in range(j, split):
            f11[index[i], column] += update[i, j]
        for i in range(split, index.size):
            f21[index[i] - own, column] += update[i, j]
    for j in range(split, index.size):
        column = index[j] - own
        for i in range(j, index.size):
            f22[index[i] - own, column] += update[i, j]
