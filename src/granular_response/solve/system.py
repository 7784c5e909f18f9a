"""The static equations of a packing: forces by the return map, tangent stiffness, factorisation.

A :class:`StaticSystem` belongs to one packing and one list of candidate contacts. Configurations are displacements
``q`` (``[x | z | angle]``) from its reference positions together with the springs, so that overlaps keep their
digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigs, eigsh

from ..kernels import statics
from ..kernels.neighbours import close_pairs
from ..state import SLIDING, STICKING, Contacts, FloatArray, State, wall_normals
from .linear import REMEMBERED, Factor, Sequence, elimination
from .linear.band import Band
from .linear.two_sided import FREEDOMS, TwoSided
from .pattern import pattern
from .problem import Problem

#: Added to the tangent's diagonal, in units of the normal stiffness: holds disks that nothing holds.
REGULARISATION = 1e-10

#: Part of the force out of balance that a step by the factorisation of another tangent leaves (2-norms).
LEFT_OVER = 1e-6

#: Difference of two shifts, in units of the normal stiffness, that solutions by the factorisation with one of them make
#: up for with little effort: below the softest modes of a packing of some hundred layers.
SAME_SHIFT = 1e-7

#: Relative accuracy of an eigenvalue of which the direction is asked, and vectors among which it is looked for.
ROUGH, FEW = 1e-3, 6

#: Stiffness that keeps disks that roll freely from counting as unstable.
FREE = 1e-6

#: Eigenvalues that are looked for where one is negative, vectors among which they are, and among which one is that is
#: known roughly.
SOUGHT, AMONG, AMONG_FEW = 4, 14, 6

#: Relative accuracies with which the distance of the lowest from a point is found, until its sign is certain: it is
#: where it is so many times as far from zero as the accuracy of this distance.
ACCURACIES, CERTAIN = (1e-3, 1e-4, 1e-5, 1e-6), 10.0
#: Accuracy at last, in parts of the shift that keeps what moves freely from counting.
SIGN = 0.1

#: How far to the left of zero they are looked for, in units of the normal stiffness: the first that the symmetric part
#: allows. The nearer, the farther apart eigenvalues near zero are from there.
LEFT_OF_ALL = (1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0, 10.0)

#: Most unknowns of a tangent whose eigenvalues are found as those of a dense matrix.
DENSE = 12
#: Part of a distance by which rounding may part two disks that touch.
TOUCHING = 1e-12


@dataclass(frozen=True)
class Configuration:
    """A static configuration: displacements and everything the return map remembers."""

    q: FloatArray  #: (dof,)
    pair_spring: FloatArray  #: (m,)
    wall_spring: FloatArray  #: (w,)
    pair_overlap: FloatArray  #: (m,)
    wall_overlap: FloatArray  #: (w,)

    @property
    def springs(self) -> FloatArray:
        """(m + w,) springs of all candidates."""
        return np.concatenate([self.pair_spring, self.wall_spring])


@dataclass(frozen=True)
class Trial:
    """Forces at a trial configuration reached in one increment from another."""

    configuration: Configuration
    contact_force: FloatArray  #: (dof,) sum of contact forces and torques on each disk, 0 where it is held
    pair_normal: FloatArray
    pair_tangential: FloatArray
    pair_status: np.ndarray
    wall_normal: FloatArray
    wall_tangential: FloatArray
    wall_status: np.ndarray
    pair_tangent: FloatArray  #: (m, 3, 3)
    wall_tangent: FloatArray  #: (w, 3, 3)

    @cached_property
    def status(self) -> np.ndarray:
        """(m + w,) statuses of all candidates."""
        return np.concatenate([self.pair_status, self.wall_status])

    @cached_property
    def sense(self) -> np.ndarray:
        """(m + w,) statuses, negative for contacts that slide against the tangent."""
        tangential = np.concatenate([self.pair_tangential, self.wall_tangential])
        return np.where((self.status == SLIDING) & (tangential < 0), -self.status, self.status)


def _slides(trial: Trial) -> bool:
    return SLIDING in trial.pair_status or SLIDING in trial.wall_status


class StaticSystem:
    """Static equations of ``problem`` around the positions and candidate contacts of ``state``.

    ``updated`` : whether Newton's method may use a factorisation that is brought up to date only where contacts change.
    Its solutions are the same within their residuals.
    """

    def __init__(self, problem: Problem, state: State, *, updated: bool = False):
        self.problem = problem
        self.reference = state.position.copy()
        self.angle0 = state.angle.copy()
        self.first = state.pairs.first.astype(np.int64)
        self.second = state.pairs.second.astype(np.int64)
        self.wall_disk = state.walls.first.astype(np.int64)
        self.wall = state.walls.second
        radius = problem.packing.radius
        box = problem.packing.box
        d = box.separation(self.reference[self.first], self.reference[self.second])
        self.dx0, self.dz0 = np.ascontiguousarray(d[:, 0]), np.ascontiguousarray(d[:, 1])
        self.gap0 = np.hypot(d[:, 0], d[:, 1]) - (radius[self.first] + radius[self.second])
        self.wall_gap0 = box.wall_gap(self.reference[self.wall_disk], radius[self.wall_disk], self.wall)
        self.wall_normals = wall_normals(self.wall)
        distance = np.sqrt(self.dx0 * self.dx0 + self.dz0 * self.dz0)  # rounded as that of a trial where nothing moves
        self._pairs = statics.Pairs(
            self.first, self.second, self.dx0, self.dz0, distance, self.gap0,
            problem.pair_shapes(self.first, self.second), problem.pair_law,
        )  # fmt: skip
        self._walls = statics.Walls(
            self.wall_disk, self.wall_normals, self.wall_gap0, problem.wall_shapes(self.wall_disk), problem.wall_law
        )
        self.held = problem.held.unknowns(problem.n)
        # one order of elimination for all states of a large lattice
        as_built = problem.n > REMEMBERED and problem.packing.ordered
        position = problem.packing.position if as_built else self.reference
        chosen = elimination(position, self.first, self.second, problem.freedoms)
        self._order = chosen.order
        self._pattern = pattern(chosen, self.first, self.second, self.wall_disk, problem.freedoms, self.held)
        self._storage = self._pattern.storage
        self._kept: tuple[np.ndarray, Factor] | None = None
        same = SAME_SHIFT * problem.stiffness
        self._steps = Sequence(self._storage, definite=False, same=same)
        self._definite_steps = Sequence(self._storage, definite=True, same=same)
        self._two_sided = self._both_ends(REGULARISATION) if updated else None
        #: the same with limits of friction held fixed, by what is added to the diagonal
        self._limited: dict[float, TwoSided] = {}
        #: place in ``LEFT_OF_ALL`` that was left of all eigenvalues of the last tangent that was looked at
        self._left = 0

    @property
    def dof(self) -> int:
        return self.problem.n * self.problem.freedoms

    def start(self, state: State) -> Configuration:
        """The configuration of a state of the same candidates."""
        shift = (state.position - self.reference).T.ravel()
        q = np.concatenate([shift, state.angle - self.angle0])[: self.dof]
        return self._known(q, state.pairs.spring, state.walls.spring)

    def _known(self, q, pair_spring, wall_spring) -> Configuration:
        bare = Configuration(
            q,
            pair_spring.copy(),
            wall_spring.copy(),
            np.zeros(len(self.first)),
            np.zeros(len(self.wall_disk)),
        )
        return replace(self.trial(bare, q).configuration, pair_spring=bare.pair_spring, wall_spring=bare.wall_spring)

    def displaced(self, q: FloatArray, load_factor: float) -> FloatArray:
        """``q`` (dof,) with held coordinates where the load factor has them; ``q`` itself where nothing is held."""
        if self.held.size == 0:
            return q
        q = q.copy()
        q[self.held] = self.problem.held.shift(self.reference, load_factor)
        return q

    def held_as_in(self, other: FloatArray, q: FloatArray) -> FloatArray:
        """``q`` (dof,) with held coordinates as in ``other``; ``q`` itself where nothing is held."""
        if self.held.size == 0:
            return q
        q = q.copy()
        q[self.held] = other[self.held]
        return q

    def trial(self, known: Configuration, q: FloatArray, limits: tuple[FloatArray, FloatArray] | None = None) -> Trial:
        """Forces at ``q``, one increment after ``known``; none on what is held, where the reaction balances all.

        ``limits`` fixes the Coulomb limits of pairs (m,) and walls (w,) in place of ``mu f_n``.
        """
        problem = self.problem
        force = np.zeros(self.dof)
        pair, wall = statics.Response.empty(len(self.first)), statics.Response.empty(len(self.wall_disk))
        for response, contacts, overlap, spring, limit, friction, add in (
            (
                pair, self._pairs, known.pair_overlap, known.pair_spring, limits and limits[0],
                problem.pair_friction, statics.pair_statics,
            ),
            (
                wall, self._walls, known.wall_overlap, known.wall_spring, limits and limits[1],
                problem.wall_friction, statics.wall_statics,
            ),
        ):  # fmt: skip
            add(
                q, known.q, problem.n, problem.packing.radius, contacts, contacts.shape,
                overlap, spring if friction else None, limit if friction else None, response, force,
            )  # fmt: skip
        force[self.held] = 0.0
        return Trial(
            configuration=Configuration(q, pair.spring, wall.spring, pair.overlap, wall.overlap),
            contact_force=force,
            pair_normal=pair.normal,
            pair_tangential=pair.tangential,
            pair_status=pair.status,
            wall_normal=wall.normal,
            wall_tangential=wall.tangential,
            wall_status=wall.status,
            pair_tangent=pair.tangent,
            wall_tangent=wall.tangent,
        )

    def normal_forces(self, q: FloatArray) -> FloatArray:
        """(dof,) forces of contacts without friction at ``q``: those of a trial up to rounding, and no tangents."""
        force = np.zeros(self.dof)
        pairs, walls = self._pairs, self._walls
        statics.normal_forces(q, self.problem.n, pairs, pairs.shape, walls, walls.shape, force)
        force[self.held] = 0.0
        return force

    def tangent(self, trial: Trial, shift: float | FloatArray = 0.0) -> sp.csc_array:
        """K = -dF/dq with the unknowns disk by disk (see :meth:`interleave`), those that are held for themselves.

        ``shift`` (scalar or (dof,)) is added to the diagonal.
        """
        places = self._pattern
        data = np.empty(len(places.indices))
        statics.assemble(
            data, self.problem.freedoms, self.first, self.second, self.problem.packing.radius,
            trial.pair_tangent, places.base, places.stride,
            self.wall_disk, trial.wall_tangent, places.wall_base, places.wall_stride,
        )  # fmt: skip
        if self.held.size:
            data[places.held_entries] = 0.0
            data[places.held_diagonal] = self.problem.stiffness
        data[places.diagonal] += shift
        return places.matrix(data)

    def elastic_energy(self, trial: Trial) -> float:
        """Energy of the normal springs (mean disk weight times mean radius)."""
        total = 0.0
        c = trial.configuration
        for overlap, contacts in ((c.pair_overlap, self._pairs), (c.wall_overlap, self._walls)):
            energies = np.zeros(len(overlap))
            statics.elastic_energies(overlap, contacts.shape, contacts.law, energies)
            total += float(energies.sum())
        return total

    def interleave(self, vector: FloatArray) -> FloatArray:
        """``[x | z | angle]`` to disk by disk, in the order of the tangent."""
        return vector[self._pattern.interleaved]

    def deinterleave(self, vector: FloatArray) -> FloatArray:
        """Disk by disk, in the order of the tangent, to ``[x | z | angle]``.

        Nothing holds a packing with periodic sides on a smooth floor along x, unless a load does: as a whole it stays
        where it is.
        """
        result = np.empty(self.dof)
        result[self._pattern.interleaved] = vector
        if self.problem.packing.periodic and not self.problem.wall_friction and 0 not in self.problem.held.axis:
            along = result[: self.problem.n]
            along -= along.mean()
        return result

    def factorise(self, trial: Trial, shift: float | FloatArray = 0.0) -> Factor:
        """LU of the tangent, a tiny regularisation included."""
        return self._factorise(trial, shift, self._regularised(trial, shift))

    def _regularised(self, trial: Trial, shift: float | FloatArray) -> sp.csc_array:
        """The tangent with ``shift`` and a tiny regularisation."""
        return self.tangent(trial, np.asarray(shift) + REGULARISATION * self.problem.stiffness)

    def _factorise(self, trial: Trial, shift: float | FloatArray, matrix: sp.csc_array) -> Factor:
        self._forget()
        factor = self._storage.factor(matrix)
        self._keep(trial, factor, shift)
        return factor

    def _forget(self) -> None:
        """Let all factorisations go before one is made: two need not be in memory."""
        self._kept = None
        self._steps.forget()
        self._definite_steps.forget()

    def _keep(self, trial: Trial, factor: Factor, shift: float | FloatArray) -> None:
        """Keep the factorisation of a tangent for trials with the same statuses, unless it has a shift."""
        self._kept = (trial.sense, factor) if np.ndim(shift) == 0 and shift == 0.0 else None

    def step(self, trial: Trial, force: FloatArray, shift: float = 0.0) -> FloatArray:
        """(dof,) displacements that take ``force`` up, by the tangent with ``shift`` on its diagonal.

        In a large packing by iteration, with a rough factorisation that may be brought up to date for what has changed
        since. RuntimeError where the tangent is exactly singular.
        """
        right = self.interleave(force)
        matrix = self._regularised(trial, shift)
        self._kept = None
        found = self._steps.solve(matrix, right, LEFT_OVER, shift)
        if found is None:
            return self.deinterleave(self._factorise(trial, shift, matrix).solve(right))
        if self._steps.factor is not None:
            self._keep(trial, self._steps.factor, shift)
        return self.deinterleave(found)

    def nearby_step(self, trial: Trial, force: FloatArray) -> FloatArray:
        """As :meth:`step`, by a factorisation of a tangent near that of the trial where one is at hand."""
        factor = self.updated_factor(trial, anew=False)[0] if self.updated else self.kept_factor(trial)
        if factor is None:
            return self.step(trial, force)
        return self.deinterleave(factor.solve(self.interleave(force)))

    def transposed_factor(self, trial: Trial) -> tuple[Factor, sp.csc_array]:
        """Factorisation of the transposed tangent, a tiny regularisation included, and that matrix without it."""
        regularised = self.tangent(trial, REGULARISATION * self.problem.stiffness)
        factor = self._storage.factor(self._pattern.transposed(regularised))
        return factor, self._pattern.transposed(self.tangent(trial))

    def limited_step(
        self, trial: Trial, force: FloatArray, shift: float, *, anew: bool = False
    ) -> tuple[FloatArray, bool]:
        """As :meth:`step` with fixed limits of friction, and whether anything had to be factorised.

        By a factorisation that is brought up to date where contacts have changed, if the system has one: the step is
        then that of a tangent nearby. ``anew`` : whether the last one did not serve.
        """
        if not self.updated:
            return self.step(trial, force, shift), True
        kept = self._limited.get(shift) or self._both_ends(shift / self.problem.stiffness)
        assert kept is not None  # as the system has one
        self._limited[shift] = kept
        if anew:
            kept.forget()
        made = kept.update(trial.pair_tangent, trial.wall_tangent)
        return self.deinterleave(kept.solve(self.interleave(force))), made

    def _both_ends(self, diagonal: float) -> TwoSided | None:
        """A factorisation that is brought up to date where contacts change; None where it is not the cheaper one.

        ``diagonal`` : what is added there, in units of the normal stiffness.
        """
        if not isinstance(self._storage, Band) or self.held.size or self.problem.freedoms != FREEDOMS:
            return None
        place, loaded = self._pattern.place, self.problem.load_disk
        centre = int(place[loaded].mean()) if len(loaded) else self.problem.n // 2
        radius = self.problem.packing.radius[self._order]
        k = self.problem.stiffness
        return TwoSided(
            np.stack([place[self.first], place[self.second]], axis=1), place[self.wall_disk], radius,
            half_width=self._storage.half_width, centre=centre, diagonal=diagonal * k, stiffness=k,
        )  # fmt: skip

    @property
    def updated(self) -> bool:
        """Whether a factorisation is brought up to date where contacts change."""
        return self._two_sided is not None

    def updated_factor(self, trial: Trial, *, anew: bool) -> tuple[Factor, bool]:
        """Factorisation of a tangent near that of a trial, and whether any of it had to be made.

        ``anew`` : whether the last one did not serve. Only where :attr:`updated`.
        """
        assert self._two_sided is not None
        if anew:
            self._two_sided.forget()
        return self._two_sided, self._two_sided.update(trial.pair_tangent, trial.wall_tangent)

    def kept_factor(self, trial: Trial) -> Factor | None:
        """The last factorisation of a tangent, when every contact has the same status (and direction of sliding)."""
        if self._kept is None or not np.array_equal(self._kept[0], trial.sense):
            return None
        return self._kept[1]

    def state(self, trial: Trial, load_factor: float) -> State:
        """The state at rest of a solved trial."""
        n = self.problem.n
        q = trial.configuration.q
        angle = self.angle0 + q[2 * n :] if self.problem.rotations else self.angle0
        c = trial.configuration
        return State(
            position=self.reference + q[: 2 * n].reshape(2, n).T,
            angle=angle.copy(),
            velocity=np.zeros((n, 2)),
            angular_velocity=np.zeros(n),
            pairs=Contacts(
                self.first.astype(np.int32), self.second.astype(np.int32), c.pair_overlap, trial.pair_normal,
                trial.pair_tangential, c.pair_spring, trial.pair_status,
            ),
            walls=Contacts(
                self.wall_disk.astype(np.int32), self.wall, c.wall_overlap, trial.wall_normal,
                trial.wall_tangential, c.wall_spring, trial.wall_status,
            ),
            box=self.problem.packing.box,
            load_factor=load_factor,
        )  # fmt: skip

    def symmetric_factor(self, trial: Trial, shift: float) -> tuple[Factor, int]:
        """Factorisation of the symmetric part of the tangent and its number of negative eigenvalues."""
        matrix = self.tangent(trial, shift)
        return self._storage.symmetric_factor(self._pattern.symmetric_part(matrix))

    def without_prestress(self, trial: Trial) -> Trial:
        """The trial with the stiffness of its springs alone: what the turn of contacts adds is left out.

        Without friction this tangent has no negative eigenvalue, and its Newton steps always go downhill.
        """
        n, q = self.problem.n, trial.configuration.q
        dx = self.dx0 + q[self.first] - q[self.second]
        dz = self.dz0 + q[n + self.first] - q[n + self.second]
        normal = np.stack([dx, dz], axis=1) / np.hypot(dx, dz)[:, None]
        stiffness = np.zeros(len(self.first))
        statics.stiffnesses(trial.configuration.pair_overlap, self._pairs.shape, self._pairs.law, stiffness)
        g = np.zeros_like(trial.pair_tangent)
        g[:, :2, :2] = -stiffness[:, None, None] * normal[:, :, None] * normal[:, None, :]
        if self.problem.pair_friction:
            tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
            stiff = np.where(trial.pair_status == STICKING, self._pairs.law.tangential_stiffness, 0.0)
            along = stiff[:, None] * tangent
            g[:, :2, :2] -= along[:, :, None] * tangent[:, None, :]
            g[:, :2, 2], g[:, 2, :2], g[:, 2, 2] = along, -along, stiff
        return replace(trial, pair_tangent=g)

    def definite_factor(self, trial: Trial, shift: float) -> Factor | None:
        """Factorisation of the symmetric part of the tangent; None when it is not positive definite."""
        self._definite_steps.forget()
        return self._storage.definite_factor(self._pattern.symmetric_part(self.tangent(trial, shift)))

    def definite_step(self, trial: Trial, force: FloatArray, shift: float) -> FloatArray | None:
        """(dof,) displacements that take ``force`` up, by the symmetric part of the tangent with ``shift`` added.

        None when it is not positive definite. In a large packing by iteration, with a rough factorisation that may be
        brought up to date for what has changed since: a tangent that is not positive definite where nothing has is not
        seen then, unless the step would lead uphill.
        """
        matrix = self._pattern.symmetric_part(self.tangent(trial, shift))
        right = self.interleave(force)
        found = self._definite_steps.solve(matrix, right, LEFT_OVER, shift)
        if found is None:
            factor = self._storage.definite_factor(matrix)
            if factor is None:
                return None
            found = factor.solve(right)
        return self.deinterleave(found)

    def meets_unlisted(self, q: FloatArray) -> bool:
        """Whether disks overlap each other or a wall that are not among the candidates: the packing has rearranged."""
        n, radius, box = self.problem.n, self.problem.packing.radius, self.problem.packing.box
        position = self.reference + q[: 2 * n].reshape(2, n).T
        first, second = close_pairs(position, radius, 0.0, box.period)
        listed = self.first * n + self.second
        if box.periodic:  # a listed pair may have met on its other side
            d = position[self.first] - position[self.second] - self.reference[self.first] + self.reference[self.second]
            apart = np.hypot(d[:, 0] + self.dx0, d[:, 1] + self.dz0)
            listed = listed[apart < (radius[self.first] + radius[self.second]) * (1.0 + TOUCHING)]
        if np.isin(first.astype(np.int64) * n + second, listed, invert=True).any():
            return True
        disk, wall = box.near_walls(position, radius, 0.0)
        return bool(np.isin(disk * 3 + wall, self.wall_disk * 3 + self.wall, invert=True).any())

    def negative_modes(self, trial: Trial) -> int:
        """Number of unstable directions of the tangent.

        Without sliding the tangent is symmetric (up to the turn of the contacts) and they are counted exactly.
        Sliding makes it unsymmetric. No eigenvalue has a smaller real part than the lowest eigenvalue of its symmetric
        part (Bendixson). Is that negative, the eigenvalue nearest to a point still further to the left is computed, as
        accurately as its sign asks: from there a real negative one is nearer than all that are not. Is it negative, the
        ``SOUGHT`` nearest are, and those with a negative real part counted. The shift ``FREE`` keeps disks that roll
        freely from counting.
        """
        matrix = self._what_moves(trial)
        modes = self._storage.negative_eigenvalues(self._pattern.symmetric_part(matrix))
        if modes == 0 or not _slides(trial):
            return modes
        if self.dof <= DENSE:
            return int((np.linalg.eigvals(matrix.toarray()).real < 0).sum())
        left = self._left_of_all(matrix)
        nearest = self._nearest_to(left, matrix)
        known: dict[str, Any] = {}
        for accuracy in (*ACCURACIES, SIGN * (FREE / -left)):
            values, vectors = nearest(1, tol=accuracy, **known)
            lowest = float(values[0].real)
            if abs(lowest) > CERTAIN * accuracy * (lowest - left):
                break
            known = {"v0": vectors[:, 0].real, "ncv": AMONG_FEW}
        return int((nearest(SOUGHT)[0].real < 0).sum()) if lowest < 0 else 0

    def _what_moves(self, trial: Trial) -> sp.csc_array:
        """The tangent shifted by ``FREE``, less the unknowns that change no force, such as the angle of a sliding disk.

        Each of them is an eigenvector of eigenvalue 0, and the rest has all other eigenvalues. Their rows, which are
        not zero, would make the symmetric part indefinite whatever the rest is.
        """
        matrix = self.tangent(trial)
        idle = np.add.reduceat(np.abs(matrix.data), matrix.indptr[:-1]) == 0.0
        matrix.data[idle[matrix.indices]] = 0.0
        matrix.data[self._pattern.diagonal] += np.where(idle, self.problem.stiffness, FREE)
        return matrix

    def _left_of_all(self, matrix: sp.csc_array) -> float:
        """A number below the lowest eigenvalue of the symmetric part of a tangent, not far below."""
        self._forget()
        symmetric = self._pattern.symmetric_part(matrix)

        def is_left(place: int) -> bool:
            if place == len(LEFT_OF_ALL) - 1:
                return True
            shifted = self._pattern.with_shift(symmetric, LEFT_OF_ALL[place] * self.problem.stiffness)
            rough = self._storage.rough_factor(shifted, definite=True) is not None
            return rough or self._storage.definite_factor(shifted) is not None

        # the first one, whichever it was last: from there it is near
        while self._left > 0 and is_left(self._left - 1):
            self._left -= 1
        while not is_left(self._left):
            self._left += 1
        return -LEFT_OF_ALL[self._left] * self.problem.stiffness

    def _nearest_to(self, left: float, matrix: sp.csc_array) -> Callable[..., tuple[NDArray[Any], NDArray[Any]]]:
        """What finds so many eigenvalues (m,) of a tangent, the nearest to a number, and their vectors (dof, m)."""
        factor = self._storage.factor(self._pattern.with_shift(matrix, -left))
        return partial(
            eigs, matrix, sigma=left, ncv=AMONG, tol=SIGN * (FREE / -left),
            OPinv=LinearOperator((self.dof, self.dof), factor.solve, dtype=float),
            v0=np.random.default_rng(0).standard_normal(self.dof),
        )  # fmt: skip

    def unstable_direction(self, trial: Trial, *, rough: bool = False) -> FloatArray:
        """(dof,) eigenvector of the lowest eigenvalue of the tangent, of largest component 1.

        ``rough`` : as accurate as a few solutions make it, which is enough to go downhill along it, without friction.
        """
        if _slides(trial):
            matrix = self._what_moves(trial)
            if self.dof <= DENSE:
                values, every = np.linalg.eig(matrix.toarray())
                return self._of_largest_one(every[:, np.argmin(values.real)].real)
            nearest = self._nearest_to(self._left_of_all(matrix), matrix)
            return self._of_largest_one(nearest(1)[1][:, 0].real)
        if self.dof <= DENSE:
            _, every = np.linalg.eigh(self._pattern.symmetric_part(self.tangent(trial)).toarray())
            return self._of_largest_one(every[:, 0])
        k = self.problem.stiffness
        # the nearer the origin of the search to the eigenvalue, the fewer solves; from below it finds the lowest
        for origin in (1e-6 * k, 1e-5 * k, 1e-4 * k, 1e-3 * k, 1e-2 * k):
            factor = self.definite_factor(trial, origin)
            if factor is not None:
                break
        else:
            factor, _ = self.symmetric_factor(trial, origin)
        _, vectors = eigsh(
            self._pattern.symmetric_part(self.tangent(trial)), k=1, sigma=-origin, which="LM",
            v0=np.random.default_rng(0).standard_normal(self.dof),
            OPinv=LinearOperator((self.dof, self.dof), factor.solve, dtype=float),
            **({"tol": ROUGH, "ncv": FEW} if rough else {}),
        )  # fmt: skip
        return self._of_largest_one(vectors[:, 0])

    def _of_largest_one(self, vector: FloatArray) -> FloatArray:
        vector = self.deinterleave(vector)
        return vector / vector[np.argmax(np.abs(vector))]
