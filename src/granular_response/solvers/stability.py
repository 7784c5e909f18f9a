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

import numpy as np
import scipy.sparse as sp

from ..errors import SolveError
from ..kernels.events import SLIDES, STICKS
from ..linalg.lowest import lowest_real
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
    #: How far to the left of zero the search begins, in units of the normal stiffness: the first that the symmetric
    #: part allows, so that there are few points on the way.
    left_of_all: tuple[float, ...] = (1e-2, 1e-1, 1.0, 10.0)
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

    Where contacts slide it is 1 if there are any. No eigenvalue has a smaller real part than the lowest of the
    symmetric part (Bendixson): if that is not negative there are none, else they are looked for
    (:func:`..linalg.lowest.lowest_real`).
    """
    matrix, _ = _scaled(system, trial)
    modes = system.storage.negative_eigenvalues(system.pattern.symmetric_part(matrix))
    if modes == 0:
        return None if _too_light(system, trial) else 0
    if not _slides(trial):
        return modes
    try:
        return int(_lowest(system, matrix)[0] < 0.0)
    except Clustered:
        return None


def unstable_direction(system: StaticSystem, trial: Trial) -> FloatArray:
    """(dof,) direction of the lowest real eigenvalue with the statuses of a trial, of largest component 1 or -1.

    Where none is negative, that of one near zero. It leads to the right as far as it leads to a side, so that of two
    mirror images one is chosen by rule.

    Raises
    ------
    Clustered
        If none is found.
    """
    matrix, scale = _scaled(system, trial)
    _, vector = _lowest(system, matrix if _slides(trial) else system.pattern.symmetric_part(matrix))
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


def _lowest(system: StaticSystem, matrix: sp.csc_array) -> tuple[float, FloatArray]:
    """The lowest real eigenvalue of a matrix if it is negative, else one near zero; and its vector (dof,).

    Raises
    ------
    Clustered
        If none is found.
    """
    system.forget()
    symmetric = system.pattern.symmetric_part(matrix)
    k = system.problem.stiffness
    for left in OPTIONS.left_of_all:
        if system.storage.definite_factor(system.pattern.with_shift(symmetric, left * k)) is not None:
            break

    def inverse(point: float) -> Callable[[FloatArray], FloatArray]:
        return system.storage.factor(system.pattern.with_shift(matrix, -point)).solve

    found = lowest_real(inverse, system.dof, -left * k)
    if found is None:
        raise Clustered
    return found
