"""Stability of equilibria: whether a small displacement grows by itself (divergence).

A packing displaced by ``x`` from equilibrium feels ``-K x``, so its linearised motion is ``M x'' + K x = 0`` with the
masses and moments of inertia ``M``. A real negative eigenvalue of ``M^-1 K`` is a direction that grows. Without sliding
K is symmetric (up to the turn of the contacts) and the negative eigenvalues are counted exactly, by Sylvester's law of
inertia. With sliding contacts K is unsymmetric and belongs to these contacts sliding on, which along a direction they
may not do: see :func:`divergence`. Complex pairs of eigenvalues, which exist wherever contacts slide, are not counted:
they oscillate, and decay or grow (flutter) by the dashpots.

That statuses which contradict a direction change until none does follows S. McNamara and H. J. Herrmann, Phys. Rev. E
74, 061303 (2006). :class:`Spectrum` counts, and gives the lowest direction; :func:`divergence` the one that contacts go
along with.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from ..errors import EquilibriumError
from ..kernels.transitions import SLIDES, STICKS
from ..linalg.lowest import Eigenpair, followed, lowest_real
from ..state import SLIDING, STICKING, FloatArray
from .free import free_disks, without_bare
from .rates import next_changes
from .system import OPTIONS as SYSTEM
from .system import StaticSystem, Trial


@dataclass(frozen=True)
class StabilityOptions:
    """Numbers by which unstable directions are looked for."""

    #: Eigenvalue of M^-1 K, in g/R, above minus which nothing counts as unstable: disks that roll freely have 0, and
    #: what grows no faster than a thousandth in sqrt(R/g) does not in any time of interest.
    neutral: float = 1e-6
    #: How far to the left of zero the search begins, in units of the normal stiffness: the first of this and its
    #: products with 10 to 1,000 that the symmetric part allows, so that there are few points on the way.
    left_of_all: float = 1e-2
    #: How far to one side a direction leads, of largest component 1, that leads to neither: that is rounding.
    aside: float = 1e-6

    @property
    def soft(self) -> float:
        """Eigenvalue from which on no direction is unstable or free, so that one factorisation settles both, clear of
        what is neutral; the softest of a packing of some hundred layers is 0.1."""
        return 100.0 * self.neutral


OPTIONS = StabilityOptions()

#: Part of the normal stiffness that rounding makes of a stiffness of 0, a sum over some ten contacts that turn; softer
#: disks than that cannot be judged.
ROUNDING = 64.0 * float(np.finfo(float).eps)


class Clustered(EquilibriumError):
    """Eigenvalues so near each other that none of them is found."""

    def __init__(self) -> None:
        super().__init__("the lowest eigenvalues of an equilibrium lie so near each other that none of them is found")


class Spectrum:
    """Lowest eigenvalue of ``M^-1 K`` with the statuses of a trial, looked for once.

    ``near`` : a negative one, and its vector, of a state just before. Where it is still negative it stands for the
    lowest, and for their number.
    """

    def __init__(self, system: StaticSystem, trial: Trial, near: Eigenpair | None = None):
        self.system, self.trial = system, trial
        self._matrix, self._scale, self._idle = _scaled(system, trial)
        system.forget()
        self._followed = None if near is None else followed(self._inverse, near)

    @property
    def negative(self) -> Eigenpair | None:
        """The lowest real eigenvalue if it is negative, and its vector (dof,), scaled; None where none is found."""
        with suppress(Clustered):
            if self.negative_modes and self.lowest[0] < 0.0:
                return self.lowest
        return None

    @cached_property
    def stiff(self) -> bool:
        """Whether all eigenvalues are above ``StabilityOptions.soft``: nothing is unstable, and nothing is free.

        All but that of the packing as a whole where nothing holds it along x.
        """
        system = self.system
        raised = system.pattern.with_shift(self._symmetric, -OPTIONS.soft)
        return system.storage.negative_eigenvalues(raised) == int(system.problem.slides_freely)

    @cached_property
    def undetermined(self) -> tuple[int, ...]:
        """Disks that a motion moves which nothing resists."""
        opened = without_bare(self.system, self.trial)
        places = self._idle.reshape(-1, self.system.problem.freedoms)[:, :2]  # of disks that touch nothing, or a wall
        if opened is None and not places.any() and self.stiff:
            return ()
        return free_disks(self.system, opened or self.trial)

    @cached_property
    def negative_modes(self) -> int | None:
        """Number of real negative eigenvalues; None where it cannot be determined.

        Where contacts slide, or one was followed, it is 1 if there are any. No eigenvalue has a smaller real part than
        the lowest of the symmetric part (Bendixson): if that is not negative there are none, else they are looked for
        (:func:`..linalg.lowest.lowest_real`).
        """
        if self._followed is not None:
            return 1
        known = vars(self).get("stiff", False)  # if it has been asked
        modes = 0 if known else self.system.storage.negative_eigenvalues(self._symmetric)
        if modes == 0:
            return None if _too_light(self.system, self.trial) else 0
        if not _slides(self.trial):
            return modes
        try:
            return int(self.lowest[0] < 0.0)
        except Clustered:
            return None

    @cached_property
    def direction(self) -> FloatArray:
        """(dof,) direction of the lowest real eigenvalue, of largest component 1 or -1.

        Where none is negative, that of one near zero. It leads to the right as far as it leads to a side, so that of
        two mirror images one is chosen by rule.

        Raises
        ------
        Clustered
            If none is found.
        """
        system = self.system
        direction = system.deinterleave(self._scale * self.lowest[1])
        direction /= np.abs(direction).max()
        sideways = float(direction[: system.problem.n].sum())
        if abs(sideways) <= OPTIONS.aside:  # it leads to neither side
            sideways = float(direction[np.argmax(np.abs(direction))])
        return -direction if sideways < 0.0 else direction

    @cached_property
    def lowest(self) -> Eigenpair:
        """The lowest real eigenvalue if it is negative, else one near zero; and its vector (dof,), scaled.

        Raises
        ------
        Clustered
            If none is found.
        """
        if self._followed is not None:
            return self._followed
        k, shifted = self.system.problem.stiffness, self.system.pattern.with_shift
        self.system.forget()
        for left in (OPTIONS.left_of_all * 10**power for power in range(4)):
            if self.system.storage.definite_factor(shifted(self._symmetric, left * k)) is not None:
                break
        found = lowest_real(self._inverse, self.system.dof, -left * k)
        if found is None:
            raise Clustered
        return found

    @cached_property
    def _symmetric(self) -> sp.csc_array:
        return self.system.pattern.symmetric_part(self._matrix)

    def _inverse(self, point: float) -> Callable[[FloatArray], FloatArray]:
        """What solves with the matrix less a point."""
        matrix = self._matrix if _slides(self.trial) else self._symmetric
        return self.system.storage.factor(self.system.pattern.with_shift(matrix, -point)).solve


def divergence(spectrum: Spectrum) -> FloatArray | None:
    """(dof,) direction in which an equilibrium leaves by itself; None where none is known.

    An unstable direction of the tangent counts only if the contacts that slide do go on sliding along it: those that
    would slip back stick, which makes another tangent with another lowest direction, and so on until they agree.

    Raises
    ------
    Clustered
        If a lowest direction is not found.
    """
    if not spectrum.negative_modes:
        return None
    system, trial = spectrum.system, spectrum.trial
    sliding = np.flatnonzero(np.abs(trial.sense) == SLIDING)
    slides = trial.sense[sliding]
    for side in (1.0, -1.0):
        direction, here = side * spectrum.direction, trial
        for _ in range(SYSTEM.patience):
            what = next_changes(system, here, direction, here.sense, 0.0, 0.0).what[sliding]
            now = here.sense[sliding]
            after = np.where(what == STICKS, STICKING, np.where(what == np.sign(slides) * SLIDES, slides, now))
            if np.array_equal(after, now):
                return direction
            sense = here.sense.copy()
            sense[sliding] = after
            here = system.trial(trial.configuration, trial.configuration.q, fixed=sense)
            turned = Spectrum(system, here)
            if turned.negative_modes is None:
                raise Clustered
            if not turned.negative_modes:
                break
            direction = turned.direction if float(turned.direction @ direction) >= 0.0 else -turned.direction
        else:
            return direction
    return None


def diverging(spectrum: Spectrum) -> int | None:
    """The number of unstable directions that contacts go along with, 1 for any number where contacts slide.

    None where it is not determined.
    """
    if not spectrum.negative_modes or not _slides(spectrum.trial):
        return spectrum.negative_modes
    with suppress(Clustered):
        return int(divergence(spectrum) is not None)
    return None


def _slides(trial: Trial) -> bool:
    """Whether a contact is at a limit."""
    return bool((np.abs(trial.sense) == SLIDING).any())


def _too_light(system: StaticSystem, trial: Trial) -> bool:
    """Whether a disk bears so little that the turn of its contacts is lost in the rounding of their stiffness.

    One whose height a load holds may bear nothing.
    """
    stiffness = system.state(trial, 0.0).largest_normal_force() / system.problem.packing.radius
    held = system.problem.held
    stiffness[held.disk[held.axis == 1]] = 0.0
    return bool(((stiffness > 0.0) & (stiffness < ROUNDING * system.problem.stiffness)).any())


def _scaled(system: StaticSystem, trial: Trial) -> tuple[sp.csc_array, FloatArray, np.ndarray]:
    """``S K S`` with ``S = M^-1/2``, shifted by ``OPTIONS.neutral``, and the diagonal of S in the order of the tangent.

    Unknowns that change no force, such as the angle of a sliding disk, come third and are left out: each of them is an
    eigenvector of eigenvalue 0, and the rest has all other eigenvalues. Their rows, which are not zero, would make the
    symmetric part indefinite whatever the rest is.
    """
    matrix = system.tangent(trial)
    idle = system.pattern.without_effect(matrix)
    if idle.any():
        matrix.data[idle[matrix.indices]] = 0.0
    mass = system.interleave(1.0 / system.problem.inverse_mass)
    scale = 1.0 / np.sqrt(mass)
    matrix.data *= scale[matrix.indices] * np.repeat(scale, np.diff(matrix.indptr))
    k = system.problem.stiffness
    matrix.data[system.pattern.diagonal] += np.where(idle, k, np.maximum(OPTIONS.neutral, ROUNDING * k / mass))
    return matrix, scale, idle
