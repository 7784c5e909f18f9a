"""Rolling resistance in statics: what contacts do next along the rolling, and what that changes.

A contact that resists rolling has a second status beside that of its tangent: STICKING within the limit of its rolling
force, SLIDING at it, OPEN with the contact. Signed statuses of a packing are (m + w,), and (2 (m + w),) with rolling
resistance: those along the tangent, then those along the rolling.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels import statics
from ..kernels.events import SLIDES, STICKS
from ..state import OPEN, SLIDING, STICKING, FloatArray

if TYPE_CHECKING:
    from .equations import Equations


class Rolls:
    """Contacts of static equations that resist rolling; all arrays are over the m + w candidates."""

    def __init__(self, equations: Equations):
        problem, m, w = equations.problem, len(equations.first), len(equations.wall_disk)
        self._equations = equations
        walls = problem.wall_arms(equations.wall_disk)
        self.count, self.n = m + w, problem.n
        self.arm = np.concatenate([problem.pair_arms(equations.first, equations.second), walls])
        kinds = ((problem.pair_rolling, m), (problem.wall_rolling, w))
        #: whether a candidate resists rolling, its coefficient of rolling friction and its stiffness
        self.there = np.concatenate([np.full(size, one is not None) for one, size in kinds])
        self.friction = np.concatenate([np.full(size, 0.0 if one is None else one.friction) for one, size in kinds])
        self.stiffness = np.concatenate([np.full(size, 0.0 if one is None else one.stiffness) for one, size in kinds])
        self.first = np.concatenate([equations.first, equations.wall_disk])
        #: 0 at walls, which do not move
        self.second = np.concatenate([equations.second, np.zeros(w, np.int64)])
        self.pair = np.arange(m + w) < m

    def relative(self, v: FloatArray) -> FloatArray:
        """(3, m + w) displacement and rotation of the first body relative to the second, of displacements (dof,)."""
        parts = v.reshape(3, self.n)
        return parts[:, self.first] - np.where(self.pair, parts[:, self.second], 0.0)

    def normals(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m + w, 2) normals and (m + w,) normal stiffnesses at displacements ``q`` (dof,); 0 where it is open."""
        eq = self._equations
        moved = self.relative(q)
        m = len(eq.first)
        d = np.stack([eq.dx0 + moved[0, :m], eq.dz0 + moved[1, :m]], axis=1)
        distance = np.hypot(d[:, 0], d[:, 1])
        reach = np.hypot(eq.dx0, eq.dz0) - eq.gap0
        normal = np.concatenate([d / distance[:, None], eq.wall_normals])
        gap = eq.wall_gap0 + np.sum(moved[:2, m:].T * eq.wall_normals, axis=1)
        stiff = np.zeros(self.count)
        listed: tuple[Any, Any] = (eq.pairs, eq.walls)
        for part, overlap, contacts in zip(
            (slice(None, m), slice(m, None)), (reach - distance, -gap), listed, strict=True
        ):
            statics.stiffnesses(overlap, contacts.shape, contacts.law, stiff[part])
        return normal, stiff

    def rates(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m + w,) by how much displacements ``v`` (dof,) raise the rolling forces, if held, and lower their limits."""
        normal, stiff = self.normals(q)
        moved = self.relative(v)
        return -self.stiffness * self.arm * moved[2], self.friction * stiff * np.sum(normal * moved[:2].T, axis=1)

    def coupled(self, sense: np.ndarray) -> np.ndarray:
        """Signed statuses (2 (m + w),) of which those along the rolling are open where the contact is, else not."""
        contact, roll = sense[: self.count], sense[self.count :]
        new = np.where(roll == OPEN, STICKING, roll)
        return np.concatenate([contact, np.where((contact == OPEN) | ~self.there, OPEN, new)]).astype(sense.dtype)

    def ties(self, sense: np.ndarray) -> np.ndarray:
        """(n,) contacts of each disk that hold it against rolling."""
        held = np.abs(sense[self.count :]) == STICKING
        first = np.bincount(self.first[held], minlength=self.n)
        return first + np.bincount(self.second[held & self.pair], minlength=self.n)

    def next_changes(
        self, q: FloatArray, v: FloatArray, sense: np.ndarray, normal: FloatArray, force: FloatArray, idle: np.ndarray,
        negligible: float,
    ) -> tuple[np.ndarray, FloatArray, FloatArray]:  # fmt: skip
        """(m + w,) what contacts do next along the rolling, which force is left until then, and the rate of its fall.

        As ``kernels.events.next_changes`` along the tangent; ``normal``, ``force`` (m + w,) : normal and rolling
        forces; ``idle`` (m + w,) : contacts of rattlers.
        """
        grows, falls = self.rates(q, v)
        status = sense[self.count :]
        live = (status != OPEN) & ~idle
        what, left, rate = np.zeros(self.count, np.int8), np.zeros(self.count), np.zeros(self.count)
        sliding = live & (np.abs(status) == SLIDING)
        behind = -(np.sign(status) * grows + falls)
        turns = sliding & (behind > negligible)
        what[turns], rate[turns] = STICKS, behind[turns]
        for side in (1, -1):
            closing, room = side * grows + falls, self.friction * normal - side * force
            first = live & ~sliding & (closing > negligible) & ((rate == 0.0) | (room * rate < left * closing))
            what[first], left[first], rate[first] = side * SLIDES, room[first], closing[first]
        return what, left, rate

    def fall(self, c: int, what: int, q: FloatArray, v: FloatArray) -> float:
        """By how much displacements ``v`` (dof,) lower the force that is left until contact ``c`` does ``what``."""
        grows, falls = self.rates(q, v)
        return float(falls[c] + np.sign(what) * grows[c])

    def changed_stiffness(
        self, c: int, before: int, after: int, q: FloatArray, place: np.ndarray
    ) -> tuple[np.ndarray, FloatArray, FloatArray]:
        """(r, 6) places, left and right of what another status of contact ``c`` along the rolling adds to the tangent.

        As ``kernels.events.changed_stiffness``; ``place`` (n,) : of disks in the order of the tangent.
        """
        normal, stiff = self.normals(q)
        change = np.zeros(3)  # of the derivative of the couple by relative displacement and rotation
        for status, sign in ((after, 1.0), (before, -1.0)):
            if abs(status) == SLIDING:
                change[:2] -= sign * np.sign(status) * self.arm[c] * self.friction[c] * stiff[c] * normal[c]
            elif status == STICKING:
                change[2] -= sign * self.arm[c] ** 2 * self.stiffness[c]
        if not change.any():
            return np.zeros((0, 6), np.int64), np.zeros((0, 6)), np.zeros((0, 6))
        other = 1.0 if self.pair[c] else 0.0
        places = np.concatenate([3 * place[self.first[c]] + np.arange(3), 3 * place[self.second[c]] + np.arange(3)])
        left = np.array([0.0, 0.0, -1.0, 0.0, 0.0, other])
        return places[None], left[None], np.concatenate([change, -other * change])[None]
