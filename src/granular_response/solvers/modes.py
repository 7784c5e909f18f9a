"""The stiffness matrix of an equilibrium for users, and its lowest vibrations.

    K = -dF/dq,    K x = omega^2 M x

for small displacements x that change the status of no contact, with masses and moments of inertia M. Of K its symmetric
part is taken for vibrations: forces of contacts that stick turn with them, which adds a part that is not symmetric.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

from ..state import FloatArray, State
from .problem import Problem
from .small_loads import sticking

#: Left of all vibrations of a stable packing, in units of the normal stiffness over the mean mass: the lowest are found
#: from there.
LEFT = 1e-6


def stiffness_matrix(problem: Problem, state: State, *, sliding: str = "refuse") -> sp.csc_array:
    """(dof, dof) K, disk by disk: x, z and, where disks turn, the angle of disk 0, then those of disk 1, and so on.

    Arguments and errors as of :func:`.small_loads.influence`. What loads hold has the normal stiffness on the diagonal,
    and nothing else.
    """
    system, trial = sticking(problem, state, sliding)
    place = system.pattern.interleaved
    unknown = place % problem.n * problem.freedoms + place // problem.n
    found = system.tangent(trial).tocoo()
    entries = (found.data, (unknown[found.row], unknown[found.col]))
    matrix = sp.coo_array(entries, shape=found.shape).tocsc()
    matrix.eliminate_zeros()
    return matrix


def lowest_modes(
    problem: Problem, state: State, count: int, left_out: NDArray[np.bool_], *, sliding: str = "refuse"
) -> tuple[FloatArray, FloatArray]:
    """(count,) lowest omega^2 in g/R, growing, and (count, n, freedoms) vectors with x M x = 1; nan on what is held.

    ``left_out`` (n,) : disks that nothing holds, which stay where they are.
    """
    n, freedoms = problem.n, problem.freedoms
    free = ~np.repeat(left_out[:, None], freedoms, axis=1)
    free[problem.held.disk, problem.held.axis] = False
    chosen = np.flatnonzero(free.ravel())
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or not 1 <= count <= len(chosen):
        there_are = f"must be a whole number from 1 to {len(chosen)}" if len(chosen) else "no disk has two contacts"
        raise ValueError(f"count = {count!r}: {there_are}")
    matrix = stiffness_matrix(problem, state, sliding=sliding)[chosen][:, chosen]
    mass = 1.0 / problem.inverse_mass.reshape(freedoms, n).T.ravel()[chosen]
    scale = sp.diags_array(1.0 / np.sqrt(mass))
    symmetric = scale @ (0.5 * (matrix + matrix.T)) @ scale
    if count < len(chosen):
        start = np.random.default_rng(0).standard_normal(len(chosen))  # one of every symmetry
        left = -LEFT * problem.stiffness
        values, vectors = eigsh(symmetric.tocsc(), k=int(count), sigma=left, which="LM", v0=start)
    else:  # all, which Lanczos does not find
        values, vectors = np.linalg.eigh(symmetric.toarray())
    by = np.argsort(values)
    found = np.full((int(count), n * freedoms), np.nan)
    found[:, chosen] = (vectors[:, by] / np.sqrt(mass)[:, None]).T
    return values[by], found.reshape(int(count), n, freedoms)
