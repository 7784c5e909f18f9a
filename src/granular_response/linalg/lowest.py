"""The lowest real eigenvalue of an unsymmetric matrix, if it is negative.

From a point on the real axis the nearest eigenvalue is the one that grows fastest under the shifted inverse. It is
found by the method of Arnoldi (Y. Saad, Numerical Methods for Large Eigenvalue Problems, SIAM, 2011, ch. 6), a
factorisation and some solutions. No real eigenvalue lies nearer than it, so the next point is almost as far to the
right: from a point left of all eigenvalues on this leads to the first negative real one, or past zero.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..state import FloatArray


@dataclass(frozen=True)
class LowestOptions:
    """Numbers by which the lowest real eigenvalue is looked for."""

    #: Relative residual up to which the nearest eigenvalue is found; how many times as inaccurate its distance counts.
    residual: float = 1e-3
    certain: float = 10.0
    #: Residual to which the eigenvector is found at last.
    vector: float = 1e-9
    #: By how many times a Krylov space grows between two looks at its eigenvalues, which cost as much as a solution.
    look: float = 1.2
    #: Most vectors of a Krylov space: without restarts, since a space of some dozens does.
    most: int = 120
    #: Most points in turn; each of the usual ones comes a hundred times nearer to zero.
    points: int = 60


OPTIONS = LowestOptions()

#: A real eigenvalue and its vector (n,).
Eigenpair = tuple[float, FloatArray]


def lowest_real(
    inverse: Callable[[float], Callable[[FloatArray], FloatArray]], n: int, left: float
) -> Eigenpair | None:
    """The lowest real eigenvalue, if it is negative, else one at or above zero; and its vector (n,). None: not found.

    Parameters
    ----------
    inverse : gives, for a point s, what solves (A - s) x = b for (n,) right-hand sides b.
    n : order of A.
    left : a point to the left of all eigenvalues.
    """
    start = np.random.default_rng(0).standard_normal(n)
    point = left
    for _ in range(OPTIONS.points):
        value, vector, residual = nearest(inverse(point), start, point, OPTIONS.residual)
        distance = abs(value - point)
        error = OPTIONS.certain * residual * distance
        if value.imag == 0.0 and value.real + error < 0.0:
            found = followed(inverse, (value.real - error, vector))
            if found is not None:
                return found
        if point + distance - error >= 0.0:
            return abs(value), vector
        if error >= distance:
            break
        point += distance - error
    return None


def followed(inverse: Callable[[float], Callable[[FloatArray], FloatArray]], near: Eigenpair) -> Eigenpair | None:
    """The eigenvalue nearest to one that is ``near``, with its vector (n,), if it is real and negative; else None.

    ``inverse`` as in :func:`lowest_real`; ``near`` may be of another matrix.
    """
    beside = near[0] * (1.0 + OPTIONS.residual)  # off it by no more than it is known to
    value, vector, residual = nearest(inverse(beside), near[1], beside, OPTIONS.vector)
    real = value.imag == 0.0 and residual <= OPTIONS.residual
    return (float(value.real), vector) if real and value.real < 0.0 else None


def nearest(
    inverse: Callable[[FloatArray], FloatArray], start: FloatArray, point: float, enough: float
) -> tuple[complex, FloatArray, float]:
    """The eigenvalue nearest to a point, the real part (n,) of its vector, and the relative residual of both.

    ``inverse`` solves with the matrix less the point. The Krylov space grows from ``start`` until the residual is
    ``enough``.
    """
    n = len(start)
    most = min(OPTIONS.most, n)
    basis, hessenberg = np.empty((most + 1, n)), np.zeros((most + 1, most))
    basis[0] = start / np.linalg.norm(start)
    looked = 0
    for k in range(most):
        new = inverse(basis[k])
        for _ in range(2):  # once leaves parts along the basis that rounding makes
            along = basis[: k + 1] @ new
            new -= along @ basis[: k + 1]
            hessenberg[: k + 1, k] += along
        rest = hessenberg[k + 1, k] = np.linalg.norm(new)
        if k + 1 >= OPTIONS.look * looked or k + 1 == most or rest == 0.0:
            looked = k + 1
            values, vectors = np.linalg.eig(hessenberg[: k + 1, : k + 1])
            largest = int(np.argmax(np.abs(values)))
            residual = float(rest * abs(vectors[k, largest]) / abs(values[largest]))
            if residual <= enough or k + 1 == most or rest == 0.0:
                break
        basis[k + 1] = new / rest
    return complex(point + 1.0 / values[largest]), vectors[:, largest].real @ basis[: k + 1], residual
