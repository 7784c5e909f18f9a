"""Where the blocks of contacts go in the tangent stiffness: its sparsity, kept from one system to the next."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ..linalg import Elimination
from ..state import FloatArray

#: The last pattern with a band, after what it was made for.
_last: list[tuple[int, tuple, Pattern]] = []


class Pattern:
    """Column-compressed pattern of the tangents of n disks with ``freedoms`` unknowns each, disk by disk.

    ``chosen`` : the order of the disks; ``first``, ``second`` (m,) : pairs; ``wall_disk`` (w,) : disks at walls;
    ``held`` : unknowns, in the order ``[x | z | angle]``, that loads hold.
    """

    def __init__(self, chosen: Elimination, first, second, wall_disk, freedoms: int, held: NDArray[np.int64]):
        n, d = len(chosen.order), freedoms
        self.size = n * d
        #: (n d,) for each unknown in the order of the tangent where it is in ``[x | z | angle]``
        self.interleaved = (chosen.order[:, None] + n * np.arange(d)).ravel()
        #: (n,) for each disk its place in the order of the tangent
        self.place = np.empty(n, np.int64)
        self.place[chosen.order] = np.arange(n)
        i, j = self.place[first], self.place[second]
        nodes = np.arange(n)
        row = np.concatenate([nodes, i, j])
        column = np.concatenate([nodes, j, i])
        by = np.lexsort((row, column))
        place = np.empty(len(by), np.int64)
        place[by] = np.arange(len(by))
        count = np.bincount(column, minlength=n)
        begin = np.concatenate([[0], np.cumsum(count)])
        rank = place - begin[column]
        base = begin[column] * d * d + rank * d
        stride = count[column] * d
        m = len(i)
        ij, ji = n + np.arange(m), n + m + np.arange(m)
        order = np.stack([i, ij, ji, j], axis=1) if m else np.zeros((0, 4), np.int64)
        order = np.concatenate([order, np.repeat(self.place[wall_disk][:, None], 4, axis=1)])
        #: (m + w, 4) first entries of the blocks of contacts, and entries from one column of a block to the next; those
        #: at walls have one block
        self.base, self.stride = base[order], stride[order]
        block_rows = (row[by][:, None] * d + np.arange(d)).ravel()
        # every block column repeats its rows d times, once for each component of the column
        starts = np.repeat(begin[:-1] * d, d)
        lengths = np.repeat(count * d, d)
        indptr = np.concatenate([[0], np.cumsum(lengths)])
        offset = np.arange(indptr[-1]) - np.repeat(indptr[:-1], lengths)
        indices = block_rows[np.repeat(starts, lengths) + offset]
        #: (n d,) entries on the diagonal
        self.diagonal = (base[:n, None] + np.arange(d) * (stride[:n, None] + 1)).ravel()
        places = self.place[held % n] * d + held // n
        columns = [np.arange(indptr[k], indptr[k + 1]) for k in places]
        rows = np.flatnonzero(np.isin(indices, places)) if held.size else np.zeros(0, np.int64)
        #: entries in the rows and columns of what is held, and on their diagonal
        self.held_entries, self.held_diagonal = np.concatenate([*columns, rows]), self.diagonal[places]
        self.storage, self.dissected = chosen.storage(indptr, indices), chosen.dissection is not None
        # of 32 bits where they will do: half the memory, and scipy converts none for its own routines
        kind = sp.get_index_dtype(maxval=int(indptr[-1]))
        self.indices, self.indptr = indices.astype(kind), indptr.astype(kind)

    def matrix(self, data: FloatArray) -> sp.csc_array:
        """The matrix with the entries ``data`` (e,)."""
        return sp.csc_array((data, self.indices, self.indptr), shape=(self.size, self.size))

    def without_effect(self, matrix: sp.csc_array) -> np.ndarray:
        """(n d,) unknowns that change no force, such as the angle of a disk of which all contacts slide."""
        return np.add.reduceat(np.abs(matrix.data), self.indptr[:-1]) == 0.0

    def transposed(self, matrix: sp.csc_array) -> sp.csc_array:
        """K^T of a tangent."""
        return self.matrix(matrix.data[self.storage.across(matrix)])

    def symmetric_part(self, matrix: sp.csc_array) -> sp.csc_array:
        """(K + K^T) / 2 of a tangent."""
        return self.matrix(0.5 * (matrix.data + matrix.data[self.storage.across(matrix)]))

    def with_shift(self, matrix: sp.csc_array, shift: float) -> sp.csc_array:
        """A tangent with ``shift`` added to its diagonal."""
        data = matrix.data.copy()
        data[self.diagonal] += shift
        return self.matrix(data)


def pattern(chosen: Elimination, first, second, wall_disk, freedoms: int, held: NDArray[np.int64]) -> Pattern:
    """The pattern for these contacts; the last one again where nothing differs, as from one load to the next.

    Fronts have room of their own for numbers, so only bands serve several systems.
    """
    asked = (chosen.order, first, second, wall_disk, held)
    for unknowns, before, kept in _last:
        if unknowns == freedoms and all(map(np.array_equal, before, asked)):
            return kept
    made = Pattern(chosen, first, second, wall_disk, freedoms, held)
    if not made.dissected:
        _last[:] = [(freedoms, asked, made)]
    return made
