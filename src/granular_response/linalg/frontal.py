"""The fronts of a multifrontal factorisation (see ``linalg.multifrontal``), one after the other.

A front is a dense matrix over the unknowns ``start ... stop`` that it eliminates and the boundary, the later unknowns
that these are tied to; its blocks are ``f11`` (own, own), ``f21`` (boundary, own), ``f12`` and ``f22``, its update,
which is what it leaves for its boundary. All are stored by columns in flat arrays: in ``values`` from ``at[front]`` on
the first two or three, one after the other, in ``updates`` from ``room[front]`` on the last. Matrices with lower
triangles only are symmetric, and have no ``f12``. Fronts are of double or of single precision, whatever ``values`` is;
so are the right-hand sides that they solve for, and the routines whose addresses come with them.

Kernels work off the fronts ``first ... last`` without a return to Python, so several threads may, each on a subtree.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.typing import NDArray

from ..machine import lapack as la
from ..machine.lapack import at, call
from ..machine.machine_code import kernel


class Tree(NamedTuple):
    """The fronts of all matrices of one pattern, each after its children."""

    start: NDArray[Any]  #: (f + 1,) first unknown of each
    begin: NDArray[Any]  #: (f + 1,) where its boundary begins
    boundary: NDArray[Any]  #: (b,) unknowns of all boundaries, sorted in each
    inside: NDArray[Any]  #: (b,) their places in the parent
    child: NDArray[Any]  #: (f + 1,) where its children begin
    children: NDArray[Any]  #: (c,) fronts that leave something for it


class Matrix(NamedTuple):
    """A matrix of symmetric pattern, column-compressed."""

    indptr: NDArray[Any]
    indices: NDArray[Any]
    data: NDArray[Any]
    whole: bool  #: whether it is not symmetric
    across: NDArray[Any]  #: for each entry the one across the diagonal; none of a symmetric one


class Store(NamedTuple):
    """Where the blocks of fronts are, and room for what is needed on the way."""

    at: NDArray[Any]  #: (f,)
    values: NDArray[Any]
    pivots: NDArray[Any]  #: (n,) int32
    room: NDArray[Any]  #: (f,)
    updates: NDArray[Any]
    place: NDArray[Any]  #: (n,) for the places of a boundary


class Factors(NamedTuple):
    """Factorised fronts."""

    at: NDArray[Any]  #: (f,) where the blocks of each are
    values: NDArray[Any]
    pivots: NDArray[Any]  #: (n,) int32
    whole: bool  #: whether of a matrix that is not symmetric


@kernel(nogil=True)
def gather(tree, front, matrix, place, values, f11):
    """Fill the first blocks of a front with its columns of a matrix, and its rows if it is not symmetric."""
    start, stop = tree.start[front], tree.start[front + 1]
    begin, end = tree.begin[front], tree.begin[front + 1]
    own, outer = stop - start, end - begin
    f21 = f11 + own * own
    f12 = f21 + own * outer
    size = own * (own + outer)
    if matrix.whole:
        size += own * outer
    for k in range(f11, f11 + size):
        values[k] = 0.0
    for b in range(outer):
        place[tree.boundary[begin + b]] = b
    for column in range(own):
        for k in range(matrix.indptr[start + column], matrix.indptr[start + column + 1]):
            row = matrix.indices[k]
            if row >= stop:
                values[f21 + column * outer + place[row]] += matrix.data[k]
            elif row >= start:
                values[f11 + column * own + row - start] += matrix.data[k]
    if matrix.whole:
        for row in range(own):
            for k in range(matrix.indptr[start + row], matrix.indptr[start + row + 1]):
                column = matrix.indices[k]
                if column >= stop:
                    values[f12 + place[column] * own + row] += matrix.data[matrix.across[k]]


@kernel(nogil=True)
def add_child(tree, front, child, update, u, whole, values, f11, updates, f22):
    """Add what an earlier front has left for its boundary, in ``update`` from ``u`` on; ``whole``: not symmetric."""
    own = tree.start[front + 1] - tree.start[front]
    outer = tree.begin[front + 1] - tree.begin[front]
    begin = tree.begin[child]
    size = tree.begin[child + 1] - begin
    index = tree.inside
    f21 = f11 + own * own
    f12 = f21 + own * outer
    split = 0
    while split < size and index[begin + split] < own:
        split += 1
    for j in range(split):
        column = index[begin + j]
        for i in range(0 if whole else j, split):
            values[f11 + column * own + index[begin + i]] += update[u + j * size + i]
        for i in range(split, size):
            values[f21 + column * outer + index[begin + i] - own] += update[u + j * size + i]
    for j in range(split, size):
        column = index[begin + j] - own
        if whole:
            for i in range(split):
                values[f12 + column * own + index[begin + i]] += update[u + j * size + i]
        for i in range(split if whole else j, size):
            updates[f22 + column * outer + index[begin + i] - own] += update[u + j * size + i]


@kernel(nogil=True)
def assemble(tree, front, matrix, store):
    """A front from the matrix and its children, all of whose updates are in the store."""
    outer = tree.begin[front + 1] - tree.begin[front]
    f11, f22 = store.at[front], store.room[front]
    gather(tree, front, matrix, store.place, store.values, f11)
    for k in range(f22, f22 + outer * outer):
        store.updates[k] = 0.0
    for c in range(tree.child[front], tree.child[front + 1]):
        child = tree.children[c]
        add_child(
            tree, front, child, store.updates, store.room[child], matrix.whole,
            store.values, f11, store.updates, f22,
        )  # fmt: skip


@kernel(nogil=True)
def factorise_own(lapack, own, values, f11, pivots, p, whole, info):
    """Factorise the first block: L U if ``whole``, else Cholesky; ``info`` (1,) is not 0 where that fails."""
    if whole:
        call(lapack[la.GETRF], (own, own, at(values, f11), own, at(pivots, p), at(info, 0)))
    else:
        call(lapack[la.POTRF], (la.LOWER, own, at(values, f11), own, at(info, 0)))


@kernel(nogil=True)
def solve_columns(lapack, own, outer, values, f11, pivots, p, first, last):
    """Columns ``first ... last`` of ``f12`` to those of U."""
    one = values.dtype.type(1.0)
    f12 = at(values, f11 + own * (own + outer + first))
    call(lapack[la.LASWP], (last - first, f12, own, 1, own, at(pivots, p), 1))
    call(lapack[la.TRSM], (
        la.LEFT, la.LOWER, la.AS_IS, la.ONES, own, last - first, one, at(values, f11), own, f12, own,
    ))  # fmt: skip


@kernel(nogil=True)
def solve_rows(lapack, own, outer, values, f11, whole, first, last):
    """Rows ``first ... last`` of ``f21`` to those of L."""
    one = values.dtype.type(1.0)
    triangle, form = (la.UPPER, la.AS_IS) if whole else (la.LOWER, la.TRANSPOSED)
    f21 = at(values, f11 + own * own + first)
    call(lapack[la.TRSM], (
        la.RIGHT, triangle, form, la.GIVEN, last - first, own, one, at(values, f11), own, f21, outer,
    ))  # fmt: skip


@kernel(nogil=True)
def update_columns(lapack, own, outer, values, f11, updates, f22, whole, first, last):
    """Columns ``first ... last`` of the update, of a symmetric one from the diagonal down."""
    one = values.dtype.type(1.0)
    f21 = f11 + own * own
    if whole:
        f12 = f21 + own * (outer + first)
        call(lapack[la.GEMM], (
            la.AS_IS, la.AS_IS, outer, last - first, own, -one, at(values, f21), outer, at(values, f12), own,
            one, at(updates, f22 + outer * first), outer,
        ))  # fmt: skip
        return
    call(lapack[la.SYRK], (
        la.LOWER, la.AS_IS, last - first, own, -one, at(values, f21 + first), outer,
        one, at(updates, f22 + (outer + 1) * first), outer,
    ))  # fmt: skip
    if last < outer:
        call(lapack[la.GEMM], (
            la.AS_IS, la.TRANSPOSED, outer - last, last - first, own, -one, at(values, f21 + last), outer,
            at(values, f21 + first), outer, one, at(updates, f22 + outer * first + last), outer,
        ))  # fmt: skip


@kernel(nogil=True)
def eliminate(lapack, tree, first, last, matrix, store, info):
    """Factorise fronts from ``first`` to before ``last``; returns where it stops for ``info`` (1,) that is not 0."""
    whole = matrix.whole
    for front in range(first, last):
        assemble(tree, front, matrix, store)
        start = tree.start[front]
        own = tree.start[front + 1] - start
        outer = tree.begin[front + 1] - tree.begin[front]
        f11 = store.at[front]
        factorise_own(lapack, own, store.values, f11, store.pivots, start, whole, info)
        if info[0] != 0:
            return front
        if outer > 0:
            if whole:
                solve_columns(lapack, own, outer, store.values, f11, store.pivots, start, 0, outer)
            solve_rows(lapack, own, outer, store.values, f11, whole, 0, outer)
            update_columns(lapack, own, outer, store.values, f11, store.updates, store.room[front], whole, 0, outer)
    return last


@kernel(nogil=True)
def forward(lapack, tree, factors, first, last, x, below, outside, gathered, line):
    """Solve with L in the fronts ``first ... last``.

    ``gathered`` : what is left for unknowns from ``below`` on, which are ``outside`` (sorted); ``line`` : (b,) room.
    """
    at_front, values, pivots, whole = factors
    none, one = x.dtype.type(0.0), x.dtype.type(1.0)
    for front in range(first, last):
        start = tree.start[front]
        own = tree.start[front + 1] - start
        begin = tree.begin[front]
        outer = tree.begin[front + 1] - begin
        f11 = at(values, at_front[front])
        if whole:
            call(lapack[la.LASWP], (1, at(x, start), own, 1, own, at(pivots, start), 1))
            call(lapack[la.TRSV], (la.LOWER, la.AS_IS, la.ONES, own, f11, own, at(x, start), 1))
        else:
            call(lapack[la.TRSV], (la.LOWER, la.AS_IS, la.GIVEN, own, f11, own, at(x, start), 1))
        if outer == 0:
            continue
        f21 = at(values, at_front[front] + own * own)
        call(lapack[la.GEMV], (la.AS_IS, outer, own, one, f21, outer, at(x, start), 1, none, at(line, 0), 1))
        k = 0
        for b in range(outer):
            unknown = tree.boundary[begin + b]
            if unknown < below:
                x[unknown] -= line[b]
            else:
                while outside[k] < unknown:
                    k += 1
                gathered[k] += line[b]


@kernel(nogil=True)
def backward(lapack, tree, factors, first, last, x, line, product):
    """Solve with U, or L^T, in the fronts ``first ... last``, the last one first."""
    at_front, values, _, whole = factors
    none, one = x.dtype.type(0.0), x.dtype.type(1.0)
    for front in range(last - 1, first - 1, -1):
        start = tree.start[front]
        own = tree.start[front + 1] - start
        begin = tree.begin[front]
        outer = tree.begin[front + 1] - begin
        f11 = at(values, at_front[front])
        if outer > 0:
            for b in range(outer):
                line[b] = x[tree.boundary[begin + b]]
            if whole:
                f12 = at(values, at_front[front] + own * (own + outer))
                call(lapack[la.GEMV], (
                    la.AS_IS, own, outer, one, f12, own, at(line, 0), 1, none, at(product, 0), 1,
                ))  # fmt: skip
            else:
                f21 = at(values, at_front[front] + own * own)
                call(lapack[la.GEMV], (
                    la.TRANSPOSED, outer, own, one, f21, outer, at(line, 0), 1, none, at(product, 0), 1,
                ))  # fmt: skip
            for k in range(own):
                x[start + k] -= product[k]
        if whole:
            call(lapack[la.TRSV], (la.UPPER, la.AS_IS, la.GIVEN, own, f11, own, at(x, start), 1))
        else:
            call(lapack[la.TRSV], (la.LOWER, la.TRANSPOSED, la.GIVEN, own, f11, own, at(x, start), 1))
