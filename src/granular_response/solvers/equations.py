"""The static equations of a packing: forces by the return map, and their tangent stiffness.

    F(q; s) + f = 0,    K = -dF/dq

for displacements ``q`` (``[x | z | angle]``) from reference positions, so that overlaps keep their digits, springs
``s``, contact forces F, gravity and loads f. :class:`.system.StaticSystem` solves with K.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ..kernels import statics
from ..linalg import REMEMBERED, elimination
from ..state import SLIDING, STICKING, Contacts, FloatArray, State, wall_normals
from .close_pairs import close_pairs
from .pattern import pattern
from .problem import Problem
from .rolling import Rolls

#: Part of a distance by which rounding may part two disks that touch.
TOUCHING = 1e-12


@dataclass(frozen=True)
class Configuration:
    """A static configuration: displacements and everything the return map remembers of its m + w candidates.

    Contacts between disks come first, contacts at walls after them, here as everywhere in statics.
    """

    q: FloatArray  #: (dof,)
    spring: FloatArray  #: (m + w,)
    overlap: FloatArray  #: (m + w,)
    roll: FloatArray | None = None  #: (m + w,) rolling springs; None without rolling resistance


@dataclass(frozen=True)
class Rolled:
    """Rolling resistance at a trial configuration."""

    force: FloatArray  #: (m + w,)
    status: np.ndarray  #: (m + w,)
    tangent: FloatArray  #: (m + w, 3) derivative of the couple on the first body; (0, 3) where it was not asked for


@dataclass(frozen=True)
class Trial:
    """Forces at a trial configuration reached in one increment from another."""

    configuration: Configuration
    contact_force: FloatArray  #: (dof,) sum of contact forces and torques on each disk, 0 where it is held
    normal: FloatArray  #: (m + w,)
    tangential: FloatArray  #: (m + w,)
    status: np.ndarray  #: (m + w,)
    tangent: FloatArray  #: (m + w, 3, 3); (0, 3, 3) where it was not asked for
    rolled: Rolled | None = None

    @cached_property
    def sense(self) -> np.ndarray:
        """(m + w,) statuses, negative for contacts that slide against the tangent; twice as many with rolling."""
        sense = signed_status(self.status, self.tangential)
        if self.rolled is None:
            return sense
        return np.concatenate([sense, signed_status(self.rolled.status, self.rolled.force)])

    @property
    def borne(self) -> FloatArray:
        """Normal force beside each status of :attr:`sense`."""
        return self.normal if self.rolled is None else np.concatenate([self.normal, self.normal])


def signed_status(status: np.ndarray, tangential: FloatArray) -> np.ndarray:
    """Statuses with the direction of sliding: negative where the tangential force is."""
    return np.where((status == SLIDING) & (tangential < 0.0), -status, status)


class Equations:
    """Static equations of ``problem`` around the positions and candidate contacts of ``state``."""

    def __init__(self, problem: Problem, state: State):
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
        self.pairs = statics.Pairs(
            self.first, self.second, self.dx0, self.dz0, distance, self.gap0,
            problem.pair_shapes(self.first, self.second), problem.pair_law,
        )  # fmt: skip
        self.walls = statics.Walls(
            self.wall_disk, self.wall_normals, self.wall_gap0, problem.wall_shapes(self.wall_disk), problem.wall_law
        )
        self.rolls = Rolls(self) if problem.rolls else None
        self.held = problem.held.unknowns(problem.n)
        # one order of elimination for all states of a large lattice
        as_built = problem.n > REMEMBERED and problem.packing.ordered
        position = problem.packing.position if as_built else self.reference
        chosen = elimination(position, self.first, self.second, problem.freedoms)
        self.pattern = pattern(chosen, self.first, self.second, self.wall_disk, problem.freedoms, self.held)

    @property
    def dissected(self) -> bool:
        """Whether the packing is too large for a banded factorisation."""
        return self.pattern.dissected

    @property
    def dof(self) -> int:
        return self.problem.n * self.problem.freedoms

    @cached_property
    def friction(self) -> FloatArray:
        """(m + w,) coefficient of each candidate."""
        laws = self.problem.pair_law.friction, self.problem.wall_law.friction
        return np.repeat(laws, [len(self.first), len(self.wall_disk)])

    def limits(self, trial: Trial) -> FloatArray:
        """Coulomb limits of a trial, and those of rolling after them where there is any."""
        sliding = self.friction * trial.normal
        return sliding if self.rolls is None else np.concatenate([sliding, self.rolls.friction * trial.normal])

    def coupled(self, sense: np.ndarray) -> np.ndarray:
        """Signed statuses of which those along the rolling, if any, are open where the contact is."""
        return sense if self.rolls is None else self.rolls.coupled(sense)

    def status_keys(self) -> NDArray[np.int64]:
        """One number for what each status belongs to."""
        keys = self.keys()
        return keys if self.rolls is None else np.concatenate([keys, -1 - keys])

    def keys(self) -> NDArray[np.int64]:
        """(m + w,) one number for the two bodies of each candidate."""
        n = self.problem.n
        return np.concatenate([self.first * n + self.second, n * n + self.wall_disk * 3 + self.wall])

    def start(self, state: State) -> Configuration:
        """The configuration of a state of the same candidates."""
        shift = (state.position - self.reference).T.ravel()
        q = np.concatenate([shift, state.angle - self.angle0])[: self.dof]
        springs = np.concatenate([state.pairs.spring, state.walls.spring])
        roll = None
        if self.rolls is not None:
            roll = np.concatenate([state.pairs.rolling_spring, state.walls.rolling_spring])
        bare = Configuration(q, springs, np.zeros(len(springs)), roll)
        return replace(self.trial(bare, q).configuration, spring=springs, roll=roll)

    def at(self, state: State) -> Trial:
        """The state itself, with the statuses that it says its contacts have."""
        known = self.start(state)
        status = np.concatenate([state.pairs.status, state.walls.status])
        tangential = np.concatenate([state.pairs.tangential_force, state.walls.tangential_force])
        sense = signed_status(status, tangential)
        if self.rolls is not None:
            status = np.concatenate([state.pairs.rolling_status, state.walls.rolling_status])
            rolling = np.concatenate([state.pairs.rolling_force, state.walls.rolling_force])
            sense = self.coupled(np.concatenate([sense, signed_status(status, rolling)]))
        return self.trial(known, known.q, fixed=sense)

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

    def trial(
        self,
        known: Configuration,
        q: FloatArray,
        *,
        limits: FloatArray | None = None,
        fixed: np.ndarray | None = None,
        tangent: bool = True,
    ) -> Trial:
        """Forces at ``q``, one increment after ``known``; none on what is held, where the reaction balances all.

        ``limits`` (m + w,) fixes the Coulomb limits in place of ``mu f_n``; ``fixed`` (m + w,) the statuses, as of
        :func:`signed_status`, in place of the return map; both go on along the rolling where there is any. ``tangent``
        : whether local tangents are asked for.
        """
        problem = self.problem
        m, count = len(self.first), len(self.first) + len(self.wall_disk)
        force = np.zeros(self.dof)
        overlap, normal, tangential, spring = np.zeros((4, count))
        out = statics.Response(overlap, normal, tangential, spring, np.zeros(count, np.int8))
        local = np.empty((count, 3, 3)) if tangent else None
        ways: tuple[tuple[slice, Any, bool, Callable], ...] = (
            (slice(None, m), self.pairs, problem.pair_friction, statics.pair_statics),
            (slice(m, None), self.walls, problem.wall_friction, statics.wall_statics),
        )
        for part, contacts, friction, add in ways:
            add(
                q, known.q, problem.n, problem.packing.radius, contacts, contacts.shape, known.overlap[part],
                known.spring[part] if friction else None, limits[part] if friction and limits is not None else None,
                None if fixed is None else fixed[part], statics.Response(*(array[part] for array in out)),
                None if local is None else local[part], force,
            )  # fmt: skip
        roll, rolled = self._rolled(known, q, limits, fixed, tangent, out, force)
        force[self.held] = 0.0
        tangents = np.empty((0, 3, 3)) if local is None else local
        return Trial(Configuration(q, spring, overlap, roll), force, normal, tangential, out.status, tangents, rolled)

    def _rolled(
        self, known: Configuration, q: FloatArray, limits, fixed, tangent: bool, out: statics.Response,
        force: FloatArray,
    ) -> tuple[FloatArray | None, Rolled | None]:  # fmt: skip
        """Rolling springs and resistance of a trial, whose couples are added to ``force``; None without."""
        problem, rolls = self.problem, self.rolls
        if rolls is None or known.roll is None:
            return None, None
        m, count = len(self.first), rolls.count
        found = statics.RollingResponse.empty(count)
        local = np.zeros((count, 3)) if tangent else None
        ways: tuple[tuple[slice, Any, Any, Callable], ...] = (
            (slice(None, m), self.pairs, problem.pair_rolling, statics.pair_rolling),
            (slice(m, None), self.walls, problem.wall_rolling, statics.wall_rolling),
        )
        for part, contacts, rolling, add in ways:
            if rolling is not None:
                add(
                    q, known.q, problem.n, rolls.arm[part], rolling, contacts, contacts.shape,
                    statics.Response(*(array[part] for array in out)), known.overlap[part], known.roll[part],
                    None if limits is None else limits[count:][part], None if fixed is None else fixed[count:][part],
                    statics.RollingResponse(*(array[part] for array in found)),
                    None if local is None else local[part], force,
                )  # fmt: skip
        return found.spring, Rolled(found.force, found.status, np.empty((0, 3)) if local is None else local)

    def along(self, known: Configuration, q: FloatArray, ahead: FloatArray, sense: np.ndarray) -> Configuration:
        """``known`` with what its springs collect on the curved way to ``q`` beside what :meth:`trial` counts.

        ``ahead`` (dof,) : the displacement were the rates those at ``known``; ``sense`` (m + w,) : signed statuses, of
        which those that stick count. Walls do not turn.
        """
        if not self.problem.pair_friction:
            return known
        spring = known.spring.copy()
        statics.add_slip_of_curved_way(q, known.q, ahead, self.problem.n, self.pairs, sense, spring)
        return replace(known, spring=spring)

    def tangent(self, trial: Trial, shift: float | FloatArray = 0.0) -> sp.csc_array:
        """K = -dF/dq with the unknowns disk by disk (see :meth:`interleave`), those that are held for themselves.

        ``shift`` (scalar or (dof,)) is added to the diagonal.
        """
        places = self.pattern
        data = np.empty(len(places.indices))
        statics.assemble(
            data, self.problem.freedoms, self.first, self.second, self.problem.packing.radius,
            trial.tangent[: len(self.first)], places.base, places.stride,
            self.wall_disk, trial.tangent[len(self.first) :], places.wall_base, places.wall_stride,
        )  # fmt: skip
        if trial.rolled is not None:
            statics.assemble_rolling(
                data, trial.rolled.tangent[: len(self.first)], places.base, places.stride,
                trial.rolled.tangent[len(self.first) :], places.wall_base, places.wall_stride,
            )  # fmt: skip
        if self.held.size:
            data[places.held_entries] = 0.0
            data[places.held_diagonal] = self.problem.stiffness
        data[places.diagonal] += shift
        return places.matrix(data)

    def split(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, ...) and (w, ...) of what all candidates have (m + w, ...)."""
        return values[: len(self.first)], values[len(self.first) :]

    def elastic_energy(self, trial: Trial) -> float:
        """Energy of the normal springs (mean disk weight times mean radius)."""
        total = 0.0
        listed: tuple[Any, Any] = (self.pairs, self.walls)
        for overlap, contacts in zip(self.split(trial.configuration.overlap), listed, strict=True):
            energies = np.zeros(len(overlap))
            statics.elastic_energies(overlap, contacts.shape, contacts.law, energies)
            total += float(energies.sum())
        return total

    def interleave(self, vector: FloatArray) -> FloatArray:
        """``[x | z | angle]`` to disk by disk, in the order of the tangent."""
        return vector[self.pattern.interleaved]

    def deinterleave(self, vector: FloatArray) -> FloatArray:
        """Disk by disk, in the order of the tangent, to ``[x | z | angle]``.

        Nothing holds a packing with periodic sides on a smooth floor along x, unless a load does: as a whole it stays
        where it is.
        """
        result = np.empty(self.dof)
        result[self.pattern.interleaved] = vector
        if self.problem.packing.periodic and not self.problem.wall_friction and 0 not in self.problem.held.axis:
            along = result[: self.problem.n]
            along -= along.mean()
        return result

    def state(self, trial: Trial, load_factor: float) -> State:
        """The state at rest of a solved trial."""
        n = self.problem.n
        q = trial.configuration.q
        angle = self.angle0 + q[2 * n :] if self.problem.rotations else self.angle0
        c = trial.configuration
        values = [c.overlap, trial.normal, trial.tangential, c.spring, trial.status]
        if trial.rolled is not None and c.roll is not None:
            values += [trial.rolled.force, c.roll, trial.rolled.status]
        parts = zip(*map(self.split, values), strict=True)
        first, second, disk = (index.astype(np.int32) for index in (self.first, self.second, self.wall_disk))
        places = (first, second), (disk, self.wall)
        pairs, walls = (Contacts(*place, *part) for place, part in zip(places, parts, strict=True))
        return State(
            position=self.reference + q[: 2 * n].reshape(2, n).T,
            angle=angle.copy(),
            velocity=np.zeros((n, 2)),
            angular_velocity=np.zeros(n),
            pairs=pairs,
            walls=walls,
            box=self.problem.packing.box,
            load_factor=load_factor,
        )  # fmt: skip

    def force_rates(self, trial: Trial, velocity: FloatArray) -> FloatArray:
        """(dof,) rates of the contact forces where displacements grow at the rates ``velocity`` (dof,)."""
        n, radius = self.problem.n, self.problem.packing.radius
        v = np.zeros((3, n))
        v[: self.problem.freedoms] = velocity.reshape(-1, n)
        v[2] *= radius
        i, j, k = self.first, self.second, self.wall_disk
        relative = np.concatenate([(v[:2, i] - v[:2, j]), (v[2, i] + v[2, j])[None]]), v[:, k]
        total = np.zeros((3, n))
        pair, wall = (np.einsum("cab,bc->ac", g, w) for g, w in zip(self.split(trial.tangent), relative, strict=True))
        for axis in (0, 1):
            total[axis] = np.bincount(i, pair[axis], n) - np.bincount(j, pair[axis], n) + np.bincount(k, wall[axis], n)
        turning = np.bincount(i, pair[2], n) + np.bincount(j, pair[2], n) + np.bincount(k, wall[2], n)
        total[2] = -radius * turning
        if self.rolls is not None and trial.rolled is not None:
            couple = np.einsum("cb,bc->c", trial.rolled.tangent, self.rolls.relative(velocity))
            on_pairs, on_walls = self.split(couple)
            total[2] += np.bincount(i, on_pairs, n) - np.bincount(j, on_pairs, n) + np.bincount(k, on_walls, n)
        return total[: self.problem.freedoms].ravel()

    def without_prestress(self, trial: Trial) -> Trial:
        """The trial with the stiffness of its springs alone: what the turn of contacts adds is left out.

        Without friction this tangent has no negative eigenvalue, and its Newton steps always go downhill.
        """
        n, q = self.problem.n, trial.configuration.q
        dx = self.dx0 + q[self.first] - q[self.second]
        dz = self.dz0 + q[n + self.first] - q[n + self.second]
        normal = np.stack([dx, dz], axis=1) / np.hypot(dx, dz)[:, None]
        stiffness = np.zeros(len(self.first))
        statics.stiffnesses(self.split(trial.configuration.overlap)[0], self.pairs.shape, self.pairs.law, stiffness)
        tangent_of = trial.tangent.copy()
        g = tangent_of[: len(self.first)]
        g[:] = 0.0
        g[:, :2, :2] = -stiffness[:, None, None] * normal[:, :, None] * normal[:, None, :]
        if self.problem.pair_friction:
            tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
            stiff = np.where(self.split(trial.status)[0] == STICKING, self.pairs.law.tangential_stiffness, 0.0)
            along = stiff[:, None] * tangent
            g[:, :2, :2] -= along[:, :, None] * tangent[:, None, :]
            g[:, :2, 2], g[:, 2, :2], g[:, 2, 2] = along, -along, stiff
        return replace(trial, tangent=tangent_of)

    def meets_unlisted(self, q: FloatArray) -> bool:
        """Whether disks overlap each other or a wall that are not among the candidates: the packing has rearranged."""
        n, radius, box = self.problem.n, self.problem.packing.radius, self.problem.packing.box
        position = self.reference + q[: 2 * n].reshape(2, n).T
        first, second = close_pairs(position, radius, 0.0, box.period)
        listed, listed_at_wall = self.split(self.keys())
        if box.periodic:  # a listed pair may have met on its other side
            d = position[self.first] - position[self.second] - self.reference[self.first] + self.reference[self.second]
            apart = np.hypot(d[:, 0] + self.dx0, d[:, 1] + self.dz0)
            listed = listed[apart < (radius[self.first] + radius[self.second]) * (1.0 + TOUCHING)]
        if np.isin(first.astype(np.int64) * n + second, listed, invert=True).any():
            return True
        disk, wall = box.near_walls(position, radius, 0.0)
        return bool(np.isin(n * n + disk * 3 + wall, listed_at_wall, invert=True).any())
