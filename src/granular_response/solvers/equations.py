"""The static equations of a packing: forces by the return map, and their tangent stiffness.

    F(q; s) + f = 0,    K = -dF/dq

for displacements ``q`` (``[x | z | angle]``) from reference positions, so that overlaps keep their digits, springs
``s``, contact forces F, gravity and loads f. :class:`.system.StaticSystem` solves with K.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ..contact.coulomb import limit
from ..kernels import statics, transitions
from ..linalg import REMEMBERED, elimination
from ..machine.lanes import WIDTH
from ..machine.machine_code import kind, typed
from ..state import OPEN, SLIDING, STICKING, Contacts, FloatArray, State, wall_normals
from .close_pairs import close_pairs
from .pattern import pattern
from .problem import Problem

#: Ties that a load counts as: more than any disk has freedoms, so that a loaded disk is no rattler.
LOADED = 4
#: Part of a distance by which rounding may part two disks that touch.
TOUCHING = 1e-12


@dataclass(frozen=True)
class Configuration:
    """A static configuration: displacements and everything the return map remembers of its m + w candidates.

    Contacts between disks come first, contacts at walls after them, here as everywhere in statics. Springs and statuses
    follow each other row by row (``state.ROWS``), as many as the problem has.
    """

    q: FloatArray  #: (dof,)
    spring: FloatArray  #: (r (m + w),)
    overlap: FloatArray  #: (m + w,)


@dataclass(frozen=True)
class Trial:
    """Forces at a trial configuration reached in one increment from another."""

    configuration: Configuration
    contact_force: FloatArray  #: (dof,) sum of contact forces and torques on each disk, 0 where it is held
    contacts: statics.Response  #: forces, normals and statuses
    local: Callable[[], FloatArray]  #: makes :attr:`tangents`
    bend: float = 0.0  #: largest part of a spring that the curved way of a contact has made
    contradiction: float = 0.0  #: largest force by which statuses that were kept differ from the return map

    @property
    def normal(self) -> FloatArray:
        """(m + w,) normal forces."""
        return self.contacts.normal

    @property
    def tangential(self) -> FloatArray:
        """(m + w,) tangential forces."""
        return self.contacts.tangential[: len(self.normal)]

    @cached_property
    def status(self) -> np.ndarray:
        """(m + w,) statuses."""
        return np.abs(self.contacts.status[: len(self.normal)]).astype(np.int8)

    @cached_property
    def tangents(self) -> FloatArray:
        """(m + w, 3, 3) local tangents, with a second row (m + w, 4, 3); see :func:`.statics.tangents`."""
        return self.local()

    @property
    def tangent(self) -> FloatArray:
        """(m + w, 3, 3) derivatives of normal and tangential forces."""
        return self.tangents[:, :3]

    @cached_property
    def sense(self) -> np.ndarray:
        """(r (m + w),) statuses, negative for contacts that slide under a negative force."""
        return signed_status(np.abs(self.contacts.status).astype(np.int8), self.contacts.tangential)


def signed_status(status: np.ndarray, tangential: FloatArray) -> np.ndarray:
    """Statuses with the direction of sliding: negative where the tangential force is."""
    return np.where((status == SLIDING) & (tangential < 0.0), -status, status)


class Equations:
    """Static equations of ``problem`` around the positions and candidate contacts of ``state``."""

    def __init__(self, problem: Problem, state: State):
        self.problem, self.dof = problem, problem.n * problem.freedoms
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
        gap = np.hypot(d[:, 0], d[:, 1]) - (radius[self.first] + radius[self.second])
        wall_gap = box.wall_gap(self.reference[self.wall_disk], radius[self.wall_disk], self.wall)
        self.wall_normals = wall_normals(self.wall)
        distance = np.sqrt(self.dx0 * self.dx0 + self.dz0 * self.dz0)  # rounded as that of a trial where nothing moves
        self._room, self._no_rates, self._none = np.zeros(2 * WIDTH), np.zeros(self.dof), np.zeros(0)
        self.count = np.zeros((3, problem.n), np.int64)  #: room for kernels to count in
        self.rows = len(problem.laws)
        self.listed = self._list(gap, distance, wall_gap)
        # kernels that a path calls at every point
        of = kind(self.listed, problem.pair_friction or None, problem.wall_friction or None)
        self._contacts, self._count_ties = typed(statics.contacts, of), typed(transitions.count_ties, of)
        self.next_changes, self.until = typed(transitions.next_changes, of), typed(transitions.until, of)
        self.changed_stiffness = typed(transitions.changed_stiffness, of)
        self.held = problem.held.unknowns(problem.n)
        # one order of elimination for all states of a large lattice
        as_built = problem.n > REMEMBERED and problem.packing.ordered
        position = problem.packing.position if as_built else self.reference
        chosen = elimination(position, self.first, self.second, problem.freedoms)
        self.pattern = pattern(chosen, self.first, self.second, self.wall_disk, problem.freedoms, self.held)

    def _list(self, gap: FloatArray, distance: FloatArray, wall_gap: FloatArray) -> statics.Listed:
        """The candidates as kernels take them."""
        problem, m, w = self.problem, len(self.first), len(self.wall_disk)
        loaded = np.zeros(problem.n, np.int64)
        loaded[problem.load_disk] = LOADED
        shape, wall_shape = problem.shapes(self.first, self.second, self.wall_disk)
        arms = problem.arms(self.first, self.second, self.wall_disk) if self.rows > 1 else (np.zeros(0),)
        return statics.Listed(
            disks=np.stack([np.r_[self.first, self.wall_disk], np.r_[self.second, np.full(w, -1)]], axis=1),
            pairs=m,
            dx=np.concatenate([self.dx0, self.wall_normals[:, 0]]),
            dz=np.concatenate([self.dz0, self.wall_normals[:, 1]]),
            distance=np.concatenate([distance, np.ones(w)]),
            gap=np.concatenate([gap, wall_gap]),
            shape=None if shape is None or wall_shape is None else np.concatenate([shape, wall_shape]),
            **statics.of_rows(problem.laws),
            arm=np.concatenate(arms),
            radius=problem.packing.radius,
            loaded=loaded,
        )

    @cached_property
    def friction(self) -> FloatArray:
        """(r (m + w),) coefficient of each candidate in each row."""
        frictions = [[law.friction for law in row] for row in self.problem.laws]
        return np.repeat(frictions, [len(self.first), len(self.wall_disk)], axis=1).ravel()

    def limits(self, trial: Trial) -> FloatArray:
        """(r (m + w),) limits of a trial."""
        kinds = self.split(trial.normal)
        return np.concatenate([limit(*one) for row in self.problem.laws for one in zip(row, kinds, strict=True)])

    def idle(self, trial: Trial, sense: np.ndarray) -> NDArray[np.int64]:
        """Unknowns that change no force with signed statuses ``sense``: angles of disks of which no contact sticks."""
        if not self.problem.rotations:
            return np.empty(0, np.int64)
        self.count[:] = 0
        self._count_ties(self.listed, sense.astype(float), trial.normal, 0.0, self.count)
        return 2 * self.problem.n + np.flatnonzero(self.count[2] == 0)

    def coupled(self, sense: np.ndarray) -> np.ndarray:
        """Signed statuses of which those of further rows, if any, are open where the contact is, else not."""
        if self.rows == 1:
            return sense
        contact, *others = sense.reshape(self.rows, -1)
        new = np.where(np.equal(others, OPEN), STICKING, others)
        new = np.where((contact == OPEN) | (self.friction.reshape(self.rows, -1)[1:] == 0.0), OPEN, new)
        return np.concatenate([contact, *new]).astype(sense.dtype)

    def status_keys(self) -> NDArray[np.int64]:
        """(r (m + w),) one number for what each status belongs to."""
        keys = self.keys()
        return np.concatenate([keys, -1 - keys][: self.rows])

    def keys(self) -> NDArray[np.int64]:
        """(m + w,) one number for the two bodies of each candidate."""
        n = self.problem.n
        return np.concatenate([self.first * n + self.second, n * n + self.wall_disk * 3 + self.wall])

    def start(self, state: State) -> Configuration:
        """The configuration of a state of the same candidates."""
        shift = (state.position - self.reference).T.ravel()
        q = np.concatenate([shift, state.angle - self.angle0])[: self.dof]
        springs = self._of_all(state, "springs")
        bare = Configuration(q, springs, np.zeros(len(self.listed.gap)))
        return replace(self.trial(bare, q).configuration, spring=springs)

    def _of_all(self, state: State, name: str) -> np.ndarray:
        """(r (m + w),) an attribute that the contacts of a state have row by row."""
        return np.hstack([getattr(kind, name)[: self.rows] for kind in (state.pairs, state.walls)]).ravel()

    def at(self, state: State) -> Trial:
        """The state itself, with the statuses that it says its contacts have."""
        known = self.start(state)
        sense = self.coupled(signed_status(self._of_all(state, "statuses"), self._of_all(state, "forces")))
        return self.trial(known, known.q, fixed=sense)

    def displaced(self, q: FloatArray, load_factor: float) -> FloatArray:
        """``q`` (dof,) with held coordinates where the load factor has them; ``q`` itself where nothing is held."""
        if self.held.size == 0:
            return q
        q = q.copy()
        q[self.held] = self.problem.held.shift(self.reference, load_factor)
        return q

    def trial(
        self,
        known: Configuration,
        q: FloatArray,
        *,
        limits: FloatArray | None = None,
        fixed: np.ndarray | None = None,
        velocity: FloatArray | None = None,
        length: float = 0.0,
    ) -> Trial:
        """Forces at ``q``, one increment after ``known``; none on what is held, where the reaction balances all.

        ``limits`` (r (m + w),) fixes the limits in place of ``mu f_n``; ``fixed`` (r (m + w),) the statuses, as of
        :func:`signed_status`, in place of the return map.
        ``velocity`` (dof,), with ``fixed`` : rates at ``known``, by which displacements would have grown for a
        ``length`` of the load factor; the slip along the way that curves from there is counted. Walls do not turn.
        """
        problem, count, listed = self.problem, len(self.listed.gap), self.listed
        force = np.zeros(self.dof)
        out = statics.Response(*np.empty((4, count)), *np.empty((3, self.rows * count)))
        if not (problem.pair_friction and problem.wall_friction):
            out.tangential[:], out.spring[:] = 0.0, 0.0
        step = statics.Increment(
            q, known.q, self._no_rates if velocity is None else velocity, length, known.overlap, known.spring,
            self._none if limits is None else limits, self._none if fixed is None else fixed.astype(float),
        )  # fmt: skip
        bend, contradiction = self._contacts(
            step, known.spring if problem.pair_friction else None, known.spring if problem.wall_friction else None,
            listed, self._room, out, force,
        )  # fmt: skip
        if self.rows > 1:
            contradiction = max(contradiction, statics.along_rolling(step, listed, out, force))
        if self.held.size:
            force[self.held] = 0.0

        def tangent() -> FloatArray:
            local = np.empty((count, 2 + self.rows, 3))
            statics.tangents(q, known.q, known.overlap, limits is None, listed, out, local)
            return local

        return Trial(Configuration(q, out.spring, out.overlap), force, out, tangent, bend, contradiction)

    def _stiffness(self, trial: Trial) -> FloatArray:
        """(e,) entries of -dF/dq as if nothing were held."""
        places = self.pattern
        data = np.empty(len(places.indices))
        statics.assemble(data, self.problem.freedoms, self.listed, trial.tangents, places.base, places.stride)
        return data

    def tangent(self, trial: Trial, shift: float = 0.0) -> sp.csc_array:
        """K = -dF/dq with the unknowns disk by disk (see :meth:`interleave`), those that are held for themselves.

        ``shift`` is added to the diagonal.
        """
        places, data = self.pattern, self._stiffness(trial)
        if self.held.size:
            data[places.held_entries] = 0.0
            data[places.held_diagonal] = self.problem.stiffness
        data[places.diagonal] += shift
        return places.matrix(data)

    def elastic_energy(self, overlap: FloatArray) -> float:
        """Energy of the normal springs of all contacts at overlaps (m + w,)."""
        (pairs, walls), shape = self.split(overlap), self.listed.shape
        shapes = (None, None) if shape is None else self.split(shape)
        stored = statics.elastic_energy(pairs, shapes[0], self.problem.pair_law)
        return stored + statics.elastic_energy(walls, shapes[1], self.problem.wall_law)

    def split(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, ...) and (w, ...) of what all candidates have (m + w, ...)."""
        return values[: len(self.first)], values[len(self.first) :]

    def interleave(self, vector: FloatArray) -> FloatArray:
        """``[x | z | angle]`` to disk by disk, in the order of the tangent."""
        return vector[self.pattern.interleaved]

    def deinterleave(self, vector: FloatArray) -> FloatArray:
        """Disk by disk, in the order of the tangent, to ``[x | z | angle]``.

        A packing that nothing holds along x stays where it is as a whole.
        """
        result = np.empty(self.dof)
        result[self.pattern.interleaved] = vector
        if self.problem.slides_freely:
            along = result[: self.problem.n]
            along -= along.mean()
        return result

    def state(self, trial: Trial, load_factor: float) -> State:
        """The state at rest of a solved trial."""
        n = self.problem.n
        q = trial.configuration.q
        angle = self.angle0 + q[2 * n :] if self.problem.rotations else self.angle0
        rows = trial.contacts.tangential, trial.configuration.spring, np.abs(trial.contacts.status)
        values = trial.configuration.overlap, trial.normal, *(one.reshape(self.rows, -1) for one in rows)
        m = len(self.first)
        pairs = Contacts.of(self.first, self.second, *(one[..., :m] for one in values))
        walls = Contacts.of(self.wall_disk, self.wall, *(one[..., m:] for one in values))
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
        rates = np.empty(self.dof)
        rates[self.pattern.interleaved] = -(self.pattern.matrix(self._stiffness(trial)) @ self.interleave(velocity))
        return rates

    def without_prestress(self, trial: Trial) -> Trial:
        """The trial, whose pairs do not slide, without what the turn of their forces adds to their stiffness.

        Without friction this tangent has no negative eigenvalue, and its Newton steps always go downhill.
        """
        n, m, q = self.problem.n, len(self.first), trial.configuration.q
        apart = np.stack([q[self.first] - q[self.second], q[n + self.first] - q[n + self.second]])
        apart += self.dx0, self.dz0
        distance = np.hypot(*apart)
        normal = apart / distance
        along = np.stack([-normal[1], normal[0]])
        turned = trial.normal[:m] * along - trial.tangential[:m] * normal
        tangent = trial.tangent.copy()
        tangent[:m, :2, :2] -= np.einsum("ac,bc->cab", turned, along / distance)
        return replace(trial, local=lambda: tangent)

    def meets_unlisted(self, q: FloatArray) -> bool:
        """Whether disks overlap each other or a wall that are not among the candidates: the packing has rearranged."""
        n, radius, box = self.problem.n, self.problem.packing.radius, self.problem.packing.box
        position = self.reference + q[: 2 * n].reshape(2, n).T
        first, second = close_pairs(position, radius, 0.0, box.period)
        listed, listed_at_wall = self.split(self.keys())
        apart, reach = position[self.first] - position[self.second], radius[self.first] + radius[self.second]
        if box.periodic:  # a listed pair may have met on its other side
            apart += self.reference[self.second] - self.reference[self.first]
            listed = listed[np.hypot(apart[:, 0] + self.dx0, apart[:, 1] + self.dz0) < reach * (1.0 + TOUCHING)]
            if np.isin(first.astype(np.int64) * n + second, listed, invert=True).any():
                return True
        elif len(first) > np.count_nonzero((apart * apart).sum(axis=1) < reach * reach):  # as close_pairs measures
            return True
        disk, wall = box.near_walls(position, radius, 0.0)
        return bool(np.isin(n * n + disk * 3 + wall, listed_at_wall, invert=True).any())
