"""Sparse factorisation of large matrices: multifrontal, in the order of a nested dissection.

Each group of nodes, or cut between two, is eliminated as one dense front by LAPACK, so nearly all work is matrix
products (I. S. Duff and J. K. Reid, ACM Trans. Math. Softw. 9, 302, 1983). What a front leaves for its boundary is
added to its parent. Results do not depend on what other libraries are installed, and every front counts its negative
eigenvalues.

The fronts of a large matrix are split into subtrees, on which several threads work side by side, and the few fronts
above them, whose matrix products are split into blocks of columns. Neither split looks at the number of threads, and
what subtrees leave is added in the order of the tree: the bits are those of a single thread.

Besides exact factorisations there are rough ones of large matrices, for solutions by iteration (:mod:`.nearby`).
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from queue import Empty, SimpleQueue

import numpy as np
import scipy.sparse as sp
from scipy.linalg import lapack

from ..machine import threads
from ..machine.lapack import addresses
from ..state import FloatArray
from . import frontal
from .dissection import Dissection
from .factor import Entries
from .frontal import Matrix, Store, Tree

#: Numbers of exact factorisations, and of rough ones.
EXACT, ROUGH = np.dtype(np.float64), np.dtype(np.float32)


@dataclass(frozen=True)
class FrontOptions:
    """Numbers by which fronts are shared out among threads."""

    #: Unknowns from which on fronts are split; below, one thread is as fast.
    large: int = 20_000
    #: A subtree has at most one part in so many of the work.
    parts: int = 24
    #: Columns of a block of a matrix product above the subtrees.
    block: int = 240
    #: Multiplications of a factorisation that take as long as a solution takes for each number of the factors.
    multiplications: float = 6.0


OPTIONS = FrontOptions()


@dataclass(frozen=True)
class _Range:
    """Fronts ``first ... last``: a subtree with its root at the end, or all."""

    first: int
    last: int
    below: int  #: unknowns that are not beyond it
    outside: np.ndarray  #: those beyond it that it leaves something for


class Multifrontal(Entries):
    """Fronts of all matrices with the pattern of a dissected network; ``freedoms`` unknowns for each node."""

    def __init__(self, dissection: Dissection, freedoms: int):
        sizes = np.array([len(b) for b in dissection.boundary], np.int64) * freedoms
        start = dissection.start * freedoms
        begin = np.concatenate([[0], np.cumsum(sizes)])
        boundary = np.concatenate([np.zeros(0, np.int64), *dissection.boundary])
        boundary = (boundary[:, None] * freedoms + np.arange(freedoms)).ravel()
        index = np.zeros(len(boundary), np.int64)
        self._parent = np.full(len(sizes), -1)
        for front, children in enumerate(dissection.children):
            own = start[front + 1] - start[front]
            for child in children:
                later = boundary[begin[child] : begin[child + 1]]
                beyond = own + np.searchsorted(boundary[begin[front] : begin[front + 1]], later)
                index[begin[child] : begin[child + 1]] = np.where(
                    later < start[front + 1], later - start[front], beyond
                )
                self._parent[child] = front
        count = np.array([len(below) for below in dissection.children], np.int64)
        self.tree = Tree(
            start, begin, boundary, index,
            np.concatenate([[0], np.cumsum(count)]),
            np.array([child for below in dissection.children for child in below], np.int64),
        )  # fmt: skip
        self.own, self.outer = np.diff(start), sizes
        self._front_of_entries: np.ndarray | None = None
        self._split()
        self._lay_out()

    @property
    def unknowns(self) -> int:
        return int(self.tree.start[-1])

    def multiplications(self) -> FloatArray:
        """(f,) of an LU in each front; Cholesky takes half of them."""
        own, outer = self.own.astype(float), self.outer.astype(float)
        return own**3 / 3.0 + own * outer * (own + outer)

    @property
    def large(self) -> bool:
        """Whether the fronts are split."""
        return self.unknowns > OPTIONS.large

    def children(self, front: int) -> list[int]:
        """Fronts that leave something for this one."""
        return self.tree.children[self.tree.child[front] : self.tree.child[front + 1]].tolist()

    def _split(self) -> None:
        """Subtrees of no more than a part of the work, and the fronts above them."""
        fronts = len(self.own)
        start = self.tree.start
        if not self.large:
            self.ranges = [_Range(0, fronts, int(start[-1]), np.zeros(0, np.int64))]
            self.above: list[int] = []
            return
        work = self.multiplications()
        first = np.arange(fronts)
        for front, parent in enumerate(self._parent):
            if parent >= 0:
                work[parent] += work[front]
                first[parent] = min(first[parent], first[front])
        most = work[self._parent < 0].sum() / OPTIONS.parts
        small = work <= most
        roots = np.flatnonzero(small & ~((self._parent >= 0) & small[self._parent]))
        self.above = np.flatnonzero(~small).tolist()
        self.ranges = []
        for root in roots.tolist():
            outside = self.tree.boundary[self.tree.begin[root] : self.tree.begin[root + 1]]
            self.ranges.append(_Range(int(first[root]), root + 1, int(start[root + 1]), outside))

    def _lay_out(self) -> None:
        """Where the updates of a range go: on one of two stacks, and those of the children on the other."""
        fronts = len(self.own)
        self._room = np.zeros(fronts, np.int64)
        highest = [0, 0]
        second = np.zeros(fronts, np.int64)
        for span in self.ranges:
            for front in range(span.last - 1, span.first - 1, -1):
                parent = self._parent[front]
                second[front] = 1 - second[parent] if span.first <= parent < span.last else 0
            height = [0, 0]
            for front in range(span.first, span.last):
                here = int(second[front])
                self._room[front] = height[here]
                height[here] += int(self.outer[front]) ** 2
                highest[here] = max(highest[here], height[here])
                for child in self.children(front)[:1]:
                    height[1 - here] = int(self._room[child])
        self._room[second == 1] += highest[0]
        self._most = sum(highest)

    def front_of_entries(self, matrix: sp.csc_array) -> np.ndarray:
        """(e,) the front in which each entry of a matrix is eliminated."""
        if self._front_of_entries is None:
            columns = np.repeat(np.arange(self.unknowns, dtype=matrix.indices.dtype), np.diff(matrix.indptr))
            first = np.minimum(matrix.indices, columns)
            self._front_of_entries = np.repeat(np.arange(len(self.own), dtype=np.int32), self.own)[first]
        return self._front_of_entries

    def factor(self, matrix: sp.csc_array) -> LU:
        """LU with row exchanges inside the fronts."""
        return LU(self, self._factorised(matrix, whole=True))

    def negative_eigenvalues(self, matrix: sp.csc_array) -> int:
        """The number of negative eigenvalues of a symmetric matrix (Sylvester's law of inertia).

        Cholesky factorisation, and L D L^T in fronts that are not positive definite; nothing of it is kept.
        """
        return self._factorised(matrix, keep=False).negative

    def definite_factor(self, matrix: sp.csc_array) -> LU | None:
        """Cholesky factorisation; None when the matrix is not positive definite."""
        fronts = self._factorised(matrix, definite=True)
        return None if fronts.failed else LU(self, fronts)

    def rough_factor(self, matrix: sp.csc_array) -> LU | None:
        """LU in half the time that can be renewed, of single precision, for solutions by iteration (:mod:`.nearby`).

        None of a small matrix, or of one that is exactly singular to that precision.

        On the path of a large packing this saves two fifths of the time. A minimisation, whose Cholesky factorisations
        take half of that, gains nothing by it.
        """
        if not self.large:
            return None
        fronts = self._factorised(matrix, whole=True, definite=True, kind=ROUGH, left={})
        return None if fronts.failed else LU(self, fronts, matrix.data.copy())

    @cached_property
    def _at(self) -> dict[bool, np.ndarray]:
        """Where the blocks of each front are in one array, for unsymmetric matrices (True) and symmetric ones."""
        sizes = {whole: self.own * (self.own + (1 + whole) * self.outer) for whole in (False, True)}
        return {whole: np.concatenate([[0], np.cumsum(size)]) for whole, size in sizes.items()}

    def _factorised(
        self,
        matrix: sp.csc_array,
        *,
        whole: bool = False,
        definite: bool = False,
        keep: bool = True,
        kind: np.dtype = EXACT,
        left: dict[int, FloatArray] | None = None,
    ) -> _Fronts:
        """Fronts factorised: L U if ``whole``, else Cholesky, and L D L^T, or an end if ``definite``, where needed.

        ``left`` : takes up what subtrees, and fronts above them, leave. RuntimeError where a front is exactly singular,
        which has ``failed`` if ``definite``.
        """
        at = self._at[whole]
        fronts = _Fronts(
            at=at[:-1] if keep else np.zeros(len(self.own), np.int64),
            values=np.empty(int(at[-1] if keep else 0), kind),
            pivots=np.zeros(self.unknowns, np.int32),
            whole=whole,
            definite=definite,
            left=left,
        )
        _Elimination(self, matrix, fronts, keep=keep).run(self.ranges, self.above)
        if fronts.failed and not definite:
            raise RuntimeError("Factor is exactly singular")
        return fronts


@dataclass
class _Fronts:
    """Factorised fronts."""

    at: np.ndarray
    values: FloatArray
    pivots: np.ndarray
    whole: bool  #: whether of a matrix that is not symmetric
    definite: bool  #: whether a front that is not positive definite is a failure
    left: dict[int, FloatArray] | None  #: what subtrees and fronts above them have left; None: that is given away
    failed: bool = False
    negative: int = 0


class _Elimination:
    """One factorisation on its way."""

    def __init__(self, pattern: Multifrontal, matrix: sp.csc_array, fronts: _Fronts, *, keep: bool = True):
        self.pattern, self.fronts, self.whole, self.keep = pattern, fronts, fronts.whole, keep
        across = pattern.across(matrix) if fronts.whole else np.zeros(0, matrix.indices.dtype)
        self.matrix = Matrix(matrix.indptr, matrix.indices, matrix.data, fronts.whole, across)
        self.kind = fronts.values.dtype
        self.lapack = addresses(self.kind)
        #: what subtrees and fronts above them leave for the fronts above these
        self.left = {} if fronts.left is None else fronts.left
        self.free: SimpleQueue[Store] = SimpleQueue()

    def run(self, ranges: Sequence[_Range], above: Sequence[int]) -> None:
        """Eliminate subtrees and fronts above them, with what others have left already."""
        with threads.mapping(self.pattern.large) as spread:
            for negative in spread(self._subtree, ranges):
                self.fronts.negative += negative
            for front in above:
                if self.fronts.failed:
                    return
                self._above(front, spread)

    def _store(self) -> Store:
        """Room for one thread."""
        with contextlib.suppress(Empty):
            return self.free.get_nowait()
        pattern, fronts = self.pattern, self.fronts
        values = fronts.values if self.keep else np.empty(int(np.diff(pattern._at[self.whole]).max()), self.kind)
        place = np.empty(pattern.unknowns, np.int64)
        return Store(fronts.at, values, fronts.pivots, pattern._room, np.empty(pattern._most, self.kind), place)

    def _subtree(self, span: _Range) -> int:
        """Eliminate a range of fronts; returns the number of negative eigenvalues."""
        if self.fronts.failed:
            return 0
        pattern, store = self.pattern, self._store()
        info = np.zeros(1, np.int32)
        negative, front = 0, span.first
        while True:
            front = frontal.eliminate(self.lapack, pattern.tree, front, span.last, self.matrix, store, info)
            if front == span.last:
                break
            if self.whole or self.fronts.definite:
                self.fronts.failed = True
                return 0
            frontal.assemble(pattern.tree, front, self.matrix, store)
            negative += self._exchange(front, store.values, store.updates, int(store.room[front]))
            front += 1
        root = span.last - 1
        if pattern.above and pattern._parent[root] >= 0:
            begin = int(store.room[root])
            self.left[root] = store.updates[begin : begin + int(pattern.outer[root]) ** 2].copy()
        self.free.put(store)
        return negative

    def _exchange(self, front: int, values: FloatArray, updates: FloatArray, f22: int) -> int:
        """Eliminate an assembled symmetric front that is not positive definite; returns its negative eigenvalues."""
        pattern = self.pattern
        own, outer = int(pattern.own[front]), int(pattern.outer[front])
        at = int(self.fronts.at[front])
        lower, pivot, info = lapack.dsytrf(_by_columns(values, at, own, own), lower=1)
        if info > 0:
            self.fronts.failed = True
        if outer:
            f21 = _by_columns(values, at + own * own, outer, own)
            solved, _ = lapack.dsytrs(lower, pivot, np.asfortranarray(f21.T), lower=1)
            update = _by_columns(updates, f22, outer, outer)
            update -= f21 @ solved
        # of the block diagonal D, in which a 2 x 2 block has one eigenvalue of each sign
        return int((lower.diagonal()[pivot > 0] < 0).sum()) + int((pivot < 0).sum()) // 2

    def _above(self, front: int, spread: threads.Map) -> None:
        """Eliminate a front above the subtrees, its matrix products in blocks."""
        pattern, fronts, tree = self.pattern, self.fronts, self.pattern.tree
        own, outer = int(pattern.own[front]), int(pattern.outer[front])
        store = self._store()
        self.free.put(store)
        values, f11, start = store.values, int(fronts.at[front]), int(tree.start[front])
        update = np.zeros(outer * outer, self.kind)
        frontal.gather(tree, front, self.matrix, store.place, values, f11)
        for child in pattern.children(front):
            of_child = self.left.pop(child) if fronts.left is None else self.left[child]
            frontal.add_child(tree, front, child, of_child, 0, self.whole, values, f11, update, 0)
        info = np.zeros(1, np.int32)
        before = None if self.whole or fronts.definite else values[f11 : f11 + own * own].copy()
        frontal.factorise_own(self.lapack, own, values, f11, fronts.pivots, start, self.whole, info)
        if info[0] != 0:
            if before is None:
                fronts.failed = True
                return
            values[f11 : f11 + own * own] = before
            fronts.negative += self._exchange(front, values, update, 0)
            self.left[front] = update
            return
        blocks = list(pairwise([*range(0, outer, OPTIONS.block), outer]))

        def solve(block: tuple[int, int]) -> None:
            if self.whole:
                frontal.solve_columns(self.lapack, own, outer, values, f11, fronts.pivots, start, *block)
            frontal.solve_rows(self.lapack, own, outer, values, f11, self.whole, *block)

        def subtract(block: tuple[int, int]) -> None:
            frontal.update_columns(self.lapack, own, outer, values, f11, update, 0, self.whole, *block)

        spread(solve, blocks)
        spread(subtract, blocks)
        self.left[front] = update


class LU:
    """Factorised fronts: L U or, of a symmetric matrix, L L^T.

    A rough one, with the ``entries`` (e,) that it was made of, can be made anew in parts.
    """

    def __init__(self, pattern: Multifrontal, fronts: _Fronts, entries: FloatArray | None = None):
        self._pattern, self._fronts, self._entries = pattern, fronts, entries

    def solve(self, right: FloatArray) -> FloatArray:
        """The solutions for a right-hand side (n,), or for k of them (k, n), to the precision of the fronts."""
        if right.ndim == 2:
            return np.array([self.solve(row) for row in right])
        pattern, fronts, tree = self._pattern, self._fronts, self._pattern.tree
        kind = fronts.values.dtype
        x = np.array(right, kind)
        lapack = addresses(kind)
        room = int(pattern.outer.max(initial=0))
        nowhere = np.zeros(0, np.int64)
        factors = frontal.Factors(fronts.at, fronts.values, fronts.pivots, fronts.whole)

        def down(first: int, last: int, below: int, outside: np.ndarray) -> FloatArray:
            gathered = np.zeros(len(outside), kind)
            frontal.forward(lapack, tree, factors, first, last, x, below, outside, gathered, np.empty(room, kind))
            return gathered

        def up(first: int, last: int) -> None:
            product = np.empty(int(pattern.own.max()), kind)
            frontal.backward(lapack, tree, factors, first, last, x, np.empty(room, kind), product)

        with threads.mapping(pattern.large) as spread:
            gathered = spread(lambda s: down(s.first, s.last, s.below, s.outside), pattern.ranges)
            for span, part in zip(pattern.ranges, gathered, strict=True):
                x[span.outside] -= part
            for front in pattern.above:
                down(front, front + 1, len(x), nowhere)
            for front in reversed(pattern.above):
                up(front, front + 1)
            spread(lambda s: up(s.first, s.last), pattern.ranges)
        return np.asarray(x, float)

    @cached_property
    def negative_pivots(self) -> int:
        """1 where the determinant is negative, else 0."""
        fronts, tree = self._fronts, self._pattern.tree
        signs = 0
        for front, own in enumerate(self._pattern.own.tolist()):
            at, start = int(fronts.at[front]), int(tree.start[front])
            diagonal = fronts.values[at : at + own * own : own + 1]
            exchanged = fronts.pivots[start : start + own] != np.arange(1, own + 1)
            signs += int((diagonal < 0.0).sum()) + int(exchanged.sum())
        return signs % 2

    @property
    def price(self) -> float:
        """About how many solutions cost as much as it: by its multiplications for each number that it holds."""
        return float(self._pattern.multiplications().sum()) / (OPTIONS.multiplications * self._fronts.values.size)

    def renew(self, matrix: sp.csc_array, change: float, most: float) -> bool:
        """Factorise a rough one anew where entries have changed by more than ``change``, and in the fronts above.

        False, and nothing is done, where that would take more than the part ``most`` of the work of all. RuntimeError
        where it is exactly singular; the factorisation is lost then.
        """
        assert self._entries is not None
        pattern = self._pattern
        front_of = pattern.front_of_entries(matrix)
        anew = np.zeros(len(pattern.own), np.bool_)
        anew[front_of[np.abs(matrix.data - self._entries) > change]] = True
        ranges = [span for span in pattern.ranges if anew[span.first : span.last].any()]
        for span in ranges:
            anew[span.first : span.last] = True
        for front in pattern.above:
            anew[front] |= anew[pattern.children(front)].any()
        work = pattern.multiplications()
        if work[anew].sum() > most * work.sum():
            return False
        above = [front for front in pattern.above if anew[front]]
        _Elimination(pattern, matrix, self._fronts).run(ranges, above)
        if self._fronts.failed:
            raise RuntimeError("Factor is exactly singular")
        np.copyto(self._entries, matrix.data, where=anew[front_of])
        return True


def _by_columns(flat: FloatArray, begin: int, rows: int, columns: int) -> FloatArray:
    """(rows, columns) view of a matrix that is stored by columns."""
    return flat[begin : begin + rows * columns].reshape(columns, rows).T
