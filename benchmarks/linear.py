"""Factorisations of the tangent stiffness of slabs at rest: ours, LAPACK's banded ones, SuperLU and PARDISO, in turns.

`python benchmarks/linear.py OUTPUT.json [MOST_UNKNOWNS]`. With friction the tangent has three unknowns a disk and is
factorised as L U; without, two, and LAPACK, the fronts and PARDISO take it as symmetric and positive. Times are of the
numeric phase: orderings and patterns, which a run makes once, are left out, but for SuperLU, of which scipy makes them
each time. Slabs of more than MOST_UNKNOWNS are left out. PARDISO is skipped by name where `pypardiso` is not there
(`pip install pypardiso`; it finds MKL by itself or by `PYPARDISO_MKL_RT`).
"""

from __future__ import annotations

import sys
from collections.abc import Callable

from granular_response.machine import floating_point

floating_point.pin()  # one thread, the instructions of the command line, before numpy is loaded

import numpy as np  # noqa: E402
import scipy.sparse as sp  # noqa: E402
from scipy.linalg import lapack  # noqa: E402
from scipy.sparse.linalg import splu  # noqa: E402
from timing import interleaved, write  # noqa: E402

from granular_response.linalg import Storage, ordering  # noqa: E402
from granular_response.scene import Scene  # noqa: E402
from granular_response.solvers.problem import Problem  # noqa: E402
from granular_response.solvers.solution import rest_state  # noqa: E402
from granular_response.solvers.system import OPTIONS, StaticSystem  # noqa: E402

try:
    from pypardiso import PyPardisoSolver
except (ImportError, OSError) as error:  # the second one without MKL
    PyPardisoSolver, MISSING = None, [f"PARDISO: {error}".splitlines()[0]]
else:
    MISSING = []

#: layers and disks in the bottom row
SLABS = [(8, 31), (15, 61), (30, 121), (60, 241), (120, 481)]
#: Half-bandwidth up to which banded factorisations are tried.
WIDEST = 250
STIFFNESS_PER_DISK = 3000.0 / (15 * 61)

#: makes a factorisation, and gives what solves with it
Factorise = Callable[[], Callable[[np.ndarray], np.ndarray]]


def systems(layers: int, per_row: int, friction: float) -> list[tuple[sp.csc_array, Storage]]:
    """The tangent of a slab at rest and what factorises it, as a band and as fronts."""
    stiffness = STIFFNESS_PER_DISK * layers * per_row
    scene = {
        "packing": {"kind": "slab", "layers": layers, "disks_per_row": per_row},
        "contact": {"friction": friction, "normal_stiffness": stiffness},
        "preparation": {"gravity": "frictionless"},
        "loads": [],
    }
    problem = Problem.from_scene(Scene.from_dict(scene))
    state = rest_state(problem)
    widest, found = ordering.WIDEST_BAND, []
    for ordering.WIDEST_BAND in (10**9, 0):
        system = StaticSystem(problem, state)
        known = system.start(state)
        found.append((system.tangent(system.trial(known, known.q), OPTIONS.regularisation * stiffness), system.storage))
    ordering.WIDEST_BAND = widest
    return found


def entries(matrix: sp.csc_array) -> tuple[np.ndarray, np.ndarray]:
    """The column of each entry, and how far it stands below the diagonal."""
    column = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    return column, matrix.indices - column


def band_places(matrix: sp.csc_array) -> tuple[int, np.ndarray]:
    """Half-bandwidth, and where the entries go in LAPACK's storage (3 b + 1, n), columns one after the other."""
    column, below = entries(matrix)
    b = int(below.max())
    return b, column * (3 * b + 1) + 2 * b + below


def lapack_lu(matrix: sp.csc_array) -> Factorise:
    """LAPACK's banded LU, which exchanges rows."""
    b, place = band_places(matrix)

    def factorise():
        columns = np.zeros((matrix.shape[0], 3 * b + 1))
        columns.ravel()[place] = matrix.data
        lu, pivot, _ = lapack.dgbtrf(columns.T, b, b, overwrite_ab=1)
        return lambda right: lapack.dgbtrs(lu, b, b, right, pivot)[0]

    return factorise


def lapack_cholesky(matrix: sp.csc_array) -> Factorise:
    """LAPACK's banded Cholesky factorisation."""
    column, below = entries(matrix)
    lower = np.flatnonzero(below >= 0)
    b = int(below.max())
    place = (column * (b + 1) + below)[lower]

    def factorise():
        columns = np.zeros((matrix.shape[0], b + 1))
        columns.ravel()[place] = matrix.data[lower]
        factor, _ = lapack.dpbtrf(columns.T, lower=1, overwrite_ab=1)
        return lambda right: lapack.dpbtrs(factor, right, lower=1)[0]

    return factorise


def superlu(matrix: sp.csc_array) -> Factorise:
    """SuperLU as scipy has it, with the options for matrices close to symmetric and positive."""
    options = {"SymmetricMode": True}
    return lambda: splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options=options).solve


def pardiso(matrix: sp.csc_array, friction: float) -> Factorise:
    """PARDISO of MKL, its analysis made beforehand."""
    rows = sp.csr_matrix(matrix if friction else sp.triu(matrix))
    rows.sort_indices()
    solver = PyPardisoSolver(mtype=11 if friction else 2)
    right = np.ones(matrix.shape[0])
    solver.set_phase(11)
    solver._call_pardiso(rows, right)

    def factorise():
        solver.set_phase(22)
        solver._call_pardiso(rows, right)
        solver.set_phase(33)
        return lambda right: solver._call_pardiso(rows, right)

    return factorise


def methods(layers: int, per_row: int, friction: float) -> dict[str, tuple[sp.csc_array, Factorise]]:
    """What is timed: the matrix in the order of the method, and how it is factorised."""
    (banded, band), (dissected, fronts) = systems(layers, per_row, friction)
    found: dict[str, tuple[sp.csc_array, Factorise]] = {}
    if band_places(banded)[0] <= WIDEST:
        found["band, ours"] = banded, lambda: band.factor(banded).solve
        found["band, LAPACK"] = banded, (lapack_lu if friction else lapack_cholesky)(banded)
    found["fronts, ours"] = (
        dissected,
        lambda: (fronts.factor if friction else fronts.definite_factor)(dissected).solve,
    )
    found["SuperLU"] = banded, superlu(banded)
    if PyPardisoSolver is not None:
        found["PARDISO"] = banded, pardiso(banded, friction)
    return found


def measure(layers: int, per_row: int, friction: float, repeats: int) -> list[dict]:
    """One record for each method."""
    found = methods(layers, per_row, friction)
    matrix, _ = found["SuperLU"]
    right = np.random.default_rng(0).standard_normal(matrix.shape[0])
    solves = [factorise() for _, factorise in found.values()]
    factor_seconds = interleaved([factorise for _, factorise in found.values()], repeats)
    solve_seconds = interleaved([lambda solve=solve: solve(right) for solve in solves], 2 * repeats)
    rows = []
    for k, (name, (ordered, _)) in enumerate(found.items()):
        residual = np.abs(ordered @ solves[k](right) - right).max()
        rows.append(
            {
                "friction": friction,
                "unknowns": matrix.shape[0],
                "half_width": band_places(matrix)[0],
                "method": name,
                "factor_milliseconds": 1e3 * factor_seconds[k],
                "solve_milliseconds": 1e3 * solve_seconds[k],
                "relative_residual": float(residual / np.abs(right).max()),
            }
        )
        print(rows[-1], flush=True)
    return rows


def main(path: str, most: int = 10**9) -> None:
    rows = []
    for friction, freedoms in ((0.2, 3), (0.0, 2)):
        for layers, per_row in SLABS:
            if layers * per_row * freedoms <= most:
                rows += measure(layers, per_row, friction, 25 if layers < 60 else 5)
    write(path, {"skipped": MISSING, "runs": rows})


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]))
