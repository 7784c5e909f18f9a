"""Stability of equilibria: whether a small displacement grows by itself (divergence).

A packing displaced by ``x`` from equilibrium feels ``-K x``, so its linearised motion is ``M x'' + K x = 0`` with the
masses and moments of inertia ``M``. A real negative eigenvalue of ``M^-1 K`` is a direction that grows. Without sliding
K is symmetric (up to the turn of the contacts) and the negative eigenvalues are counted exactly, by Sylvester's law of
inertia. With sliding contacts K is unsymmetric and belongs to these contacts sliding on, which along a direction they
may not do: see :func:`divergence`. Complex pairs of eigenvalues, which exist wherever contacts slide, are not counted:
they oscillate, and decay or grow (flutter) by the dashpots.

That statuses which contradict a direction change until none does follows S. McNamara and H. J. Herrmann, Phys. Rev. E
74, 061303 (2006). :func:`negative_modes` counts, :func:`unstable_direction` gives the lowest, :func:`divergence` the
one that contacts go along with.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, eigsh

from ..errors import SolveError
from ..kernels.events import SLIDES, STICKS
from ..state import SLIDING, STICKING, FloatArray
from .rates import next_changes
from .system import StaticSystem, Trial


@dataclass(frozen=True)
class StabilityOptions:
    """Numbers by which unstable directions are looked for."""

    #: Eigenvalue of M^-1 K, in g/R, above minus which nothing counts as unstable: disks that roll freely have 0, and
    #: what grows no faster than a thousandth in sqrt(R/g) does not in any time of interest.
    neutral: float = 1e-6
    #: Part of the normal stiffness that rounding makes of a stiffness of 0; softer disks than that cannot be judged.
    rounding: float = 1e-14
    #: Eigenvalues that are looked for where one is negative, vectors among which they are, and among which one is that
    #: is known roughly.
    sought: int = 4
    among: int = 14
    among_few: int = 6
    #: How many times as many vectors are tried in turn, and the restarts with these, after which there is no answer.
    wider: tuple[tuple[int, int], ...] = ((1, 300), (3, 30))
    #: Relative accuracies with which the distance of the lowest from a point is found, until its sign is certain: it
    #: is where it is so many times as far from zero as the accuracy of this distance.
    accuracies: tuple[float, ...] = (1e-3, 1e-4, 1e-5, 1e-6)
    certain: float = 10.0
    #: Accuracy at last, in parts of ``neutral``.
    sign: float = 0.1
    #: How far to the left of zero they are looked for, in units of the normal stiffness: the first that the symmetric
    #: part allows. The nearer, the farther apart eigenvalues near zero are from there.
    left_of_all: tuple[float, ...] = (1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0, 10.0)
    #: Most unknowns of a tangent whose eigenvalues are found as those of a dense matrix.
    dense: int = 12
    #: Sum of displacements along x below which a direction leads to neither side, its largest component being 1.
    least_sideways: float = 1e-6
    #: Times that a direction may change the contacts that slide along it before it counts as one that grows.
    rounds: int = 12


OPTIONS = StabilityOptions()


class Clustered(SolveError, ArithmeticError):
    """Eigenvalues so near each other that none of them is found."""

    def __init__(self) -> None:
        super().__init__("the lowest eigenvalues of an equilibrium lie so near each other that none of them is found")


def negative_modes(system: StaticSystem, trial: Trial) -> int | None:
    """Number of real negative eigenvalues with the statuses of a trial; None where it cannot be determined.

    With sliding contacts no eigenvalue has a smaller real part than the lowest of the symmetric part (Bendixson). Is
    that negative, the eigenvalue nearest to a point still further to the left is computed, as accurately as its sign
    asks: from there a real negative one is nearer than all that are not. Is it negative, the ``sought`` nearest are,
    and those with a negative real part counted.
    """
    matrix, _ = _scaled(system, trial)
    modes = system.storage.negative_eigenvalues(system.pattern.symmetric_part(matrix))
    if modes == 0:
        return None if _too_light(system, trial) else 0
    if not _slides(trial):
        return modes
    if system.dof <= OPTIONS.dense:
        return int((np.linalg.eigvals(matrix.toarray()).real < 0).sum())
    left = _left_of_all(system, matrix)
    nearest = _nearest_to(system, left, matrix)
    known: dict[str, Any] = {}
    try:
        for accuracy in (*OPTIONS.accuracies, OPTIONS.sign * (OPTIONS.neutral / -left)):
            values, vectors = nearest(1, tol=accuracy, **known)
            lowest = float(values[0].real)
            if abs(lowest) > OPTIONS.certain * accuracy * (lowest - left):
                break
            known = {"v0": vectors[:, 0].real, "ncv": OPTIONS.among_few}
        return int((nearest(OPTIONS.sought)[0].real < 0).sum()) if lowest < 0 else 0
    except Clustered:
        return None


def unstable_direction(system: StaticSystem, trial: Trial) -> FloatArray:
    """(dof,) direction of the lowest eigenvalue with the statuses of a trial, of largest component 1 or -1.

    It leads to the right as far as it leads to a side, so that of two mirror images one is chosen by rule.
    """
    matrix, scale = _scaled(system, trial)
    symmetric = system.pattern.symmetric_part(matrix)
    if system.dof <= OPTIONS.dense:
        values, every = np.linalg.eig((matrix if _slides(trial) else symmetric).toarray())
        vector = every[:, np.argmin(values.real)].real
    elif _slides(trial):
        vector = _nearest_to(system, _left_of_all(system, matrix), matrix)(1)[1][:, 0].real
    else:
        k = system.problem.stiffness
        # the nearer the origin of the search to the eigenvalue, the fewer solves; from below it finds the lowest
        for origin in (1e-6 * k, 1e-5 * k, 1e-4 * k, 1e-3 * k, 1e-2 * k):
            factor = system.storage.definite_factor(system.pattern.with_shift(symmetric, origin))
            if factor is not None:
                break
        else:
            factor = system.storage.factor(system.pattern.with_shift(symmetric, origin))
        _, vectors = eigsh(
            symmetric, k=1, sigma=-origin, which="LM", v0=np.random.default_rng(0).standard_normal(system.dof),
            OPinv=LinearOperator((system.dof, system.dof), factor.solve, dtype=float),
        )  # fmt: skip
        vector = vectors[:, 0]
    direction = system.deinterleave(scale * vector)
    direction /= np.abs(direction).max()
    sideways = float(direction[: system.problem.n].sum())
    if abs(sideways) <= OPTIONS.least_sideways:
        sideways = float(direction[np.argmax(np.abs(direction))])
    return -direction if sideways < 0.0 else direction


def divergence(system: StaticSystem, trial: Trial) -> FloatArray | None:
    """(dof,) direction in which an equilibrium leaves by itself; None where there is none, or none is determined.

    An unstable direction of the tangent counts only if the contacts that slide do go on sliding along it: those that
    would slip back stick, which makes another tangent with another lowest direction, and so on until they agree.
    """
    if not negative_modes(system, trial):
        return None
    sliding = np.flatnonzero(np.abs(trial.sense) == SLIDING)
    slides = trial.sense[sliding]
    with suppress(Clustered):
        lowest = unstable_direction(system, trial)
        for side in (1.0, -1.0):
            direction, here = side * lowest, trial
            for _ in range(OPTIONS.rounds):
                what = next_changes(system, here, direction, here.sense, 0.0, 0.0).what[sliding]
                now = here.sense[sliding]
                after = np.where(what == STICKS, STICKING, np.where(what == np.sign(slides) * SLIDES, slides, now))
                if np.array_equal(after, now):
                    return direction
                sense = here.sense.copy()
                sense[sliding] = after
                here = system.trial(trial.configuration, trial.configuration.q, fixed=sense)
                if not negative_modes(system, here):
                    break
                turned = unstable_direction(system, here)
                direction = turned if float(turned @ direction) >= 0.0 else -turned
            else:
                return direction
    return None


def _slides(trial: Trial) -> bool:
    """Whether a contact is at a limit, along the tangent or the rolling."""
    return bool((np.abs(trial.sense) == SLIDING).any())


def _too_light(system: StaticSystem, trial: Trial) -> bool:
    """Whether a disk bears so little that the turn of its contacts is lost in the rounding of their stiffness."""
    n = system.problem.n
    borne = np.zeros(n)
    pair, wall = system.split(trial.normal)
    np.maximum.at(borne, system.first, pair)
    np.maximum.at(borne, system.second, pair)
    np.maximum.at(borne, system.wall_disk, wall)
    stiffness = borne / system.problem.packing.radius
    return bool((stiffness[borne > 0.0] < OPTIONS.rounding * system.problem.stiffness).any())


def _scaled(system: StaticSystem, trial: Trial) -> tuple[sp.csc_array, FloatArray]:
    """``S K S`` with ``S = M^-1/2``, shifted by ``OPTIONS.neutral``, and the diagonal of S in the order of the tangent.

    Unknowns that change no force, such as the angle of a sliding disk, are left out: each of them is an eigenvector of
    eigenvalue 0, and the rest has all other eigenvalues. Their rows, which are not zero, would make the symmetric part
    indefinite whatever the rest is.
    """
    matrix = system.tangent(trial)
    idle = np.add.reduceat(np.abs(matrix.data), matrix.indptr[:-1]) == 0.0
    matrix.data[idle[matrix.indices]] = 0.0
    mass = system.interleave(1.0 / system.problem.inverse_mass)
    scale = 1.0 / np.sqrt(mass)
    columns = np.repeat(np.arange(system.dof), np.diff(matrix.indptr))
    matrix.data *= scale[matrix.indices] * scale[columns]
    k = system.problem.stiffness
    matrix.data[system.pattern.diagonal] += np.where(idle, k, np.maximum(OPTIONS.neutral, OPTIONS.rounding * k / mass))
    return matrix, scale


def _left_of_all(system: StaticSystem, matrix: sp.csc_array) -> float:
    """A number below the lowest eigenvalue of the symmetric part of a matrix, not far below."""
    system.forget()
    symmetric = system.pattern.symmetric_part(matrix)
    for left in OPTIONS.left_of_all[:-1]:
        shifted = system.pattern.with_shift(symmetric, left * system.problem.stiffness)
        if system.storage.definite_factor(shifted) is not None:
            return -left * system.problem.stiffness
    return -OPTIONS.left_of_all[-1] * system.problem.stiffness


def _nearest_to(
    system: StaticSystem, left: float, matrix: sp.csc_array
) -> Callable[..., tuple[NDArray[Any], NDArray[Any]]]:
    """What finds so many eigenvalues (m,) of a matrix, the nearest to a number, and their vectors (dof, m).

    Where the nearest are a cluster they are looked for among more vectors.
    """
    factor = system.storage.factor(system.pattern.with_shift(matrix, -left))
    inverse = LinearOperator((system.dof, system.dof), factor.solve, dtype=float)
    start = np.random.default_rng(0).standard_normal(system.dof)
    last = OPTIONS.sign * (OPTIONS.neutral / -left)

    def nearest(
        count: int, *, tol: float = last, v0: FloatArray = start, ncv: int = OPTIONS.among
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        for more, restarts in OPTIONS.wider:
            among = min(more * ncv, system.dof - 1)
            with suppress(ArpackNoConvergence):
                return eigs(matrix, k=count, sigma=left, OPinv=inverse, v0=v0, tol=tol, ncv=among, maxiter=restarts)
        raise Clustered

    return nearest
