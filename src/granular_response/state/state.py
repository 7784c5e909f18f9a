"""The state of a packing: the one description that observables, datasets and restarts read.

Units are the reduced ones (mean disk radius, mean disk mass, g); the sign conventions are those of
``docs/architecture.md``. Arrays are never modified once a state exists.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .box import Box, FloatArray, wall_normals
from .reached import Certificate, Reached
from .status import OPEN, SLIDING


@dataclass(frozen=True, repr=False)
class Contacts:
    """Candidate contacts of one kind (between disks, or of disks with walls), each of length m.

    ``overlap`` is positive in touch; ``normal_force`` is positive in compression; ``spring`` is the elongation of the
    tangential spring (Sec. III.A); ``status`` is OPEN, STICKING or SLIDING. Without friction ``tangential_force`` and
    ``spring`` are zero and a touching contact is STICKING. Where it rolls against a resistance, ``rolling_force`` times
    the reduced radius is the couple on the first body, ``rolling_spring`` the elongation of its spring, and
    ``rolling_status`` STICKING within its limit and SLIDING at it; else they are zero and OPEN, as they are by default.
    """

    first: NDArray[np.int32]  #: (m,) index of the disk the force acts on
    second: NDArray[np.int32]  #: (m,) index of the other disk, or of the wall (FLOOR, LEFT_WALL, RIGHT_WALL)
    overlap: FloatArray
    normal_force: FloatArray
    tangential_force: FloatArray
    spring: FloatArray
    status: NDArray[np.int8]
    rolling_force: FloatArray = None  # type: ignore[assignment]
    rolling_spring: FloatArray = None  # type: ignore[assignment]
    rolling_status: NDArray[np.int8] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        for name, kind in (("rolling_force", float), ("rolling_spring", float), ("rolling_status", np.int8)):
            if getattr(self, name) is None:
                object.__setattr__(self, name, np.zeros(len(self.first), kind))

    @property
    def touching(self) -> NDArray[np.bool_]:
        """(m,) whether the contact is closed."""
        return self.status != OPEN

    @property
    def sliding(self) -> NDArray[np.bool_]:
        """(m,) whether the contact is at the Coulomb limit."""
        return self.status == SLIDING

    @property
    def resists_rolling(self) -> bool:
        """Whether some contact rolls against a resistance."""
        return bool((self.rolling_status != OPEN).any())

    def near_limit(self, friction: float, margin: float, *, rolling: bool = False) -> NDArray[np.bool_]:
        """(m,) whether the contact is closed with ``|f_t| >= (1 - margin) friction f_n``; none without friction.

        Of the force along the ``rolling`` in place of the tangential one, if asked.
        """
        limit = (1.0 - margin) * friction * self.normal_force
        force = self.rolling_force if rolling else self.tangential_force
        return self.touching & (np.abs(force) >= limit) & (friction > 0.0)

    def same_candidates(self, other: Contacts) -> bool:
        """Whether both list the same candidates in the same order, so that they subtract contact by contact."""
        return np.array_equal(self.first, other.first) and np.array_equal(self.second, other.second)

    def __repr__(self) -> str:
        count = f"{len(self.first)} candidates, {self.touching.sum()} touching, {self.sliding.sum()} sliding"
        return f"Contacts({count})"


@dataclass(frozen=True, repr=False)
class State:
    """Positions, motion and contacts of n disks at one load.

    Examples
    --------
    >>> state = result.loaded[-1]
    >>> state.position.shape, len(state.pair_force()) == len(state.pairs.first)
    ((34, 2), True)
    """

    position: FloatArray  #: (n, 2) disk centres x, z
    angle: FloatArray  #: (n,) rotation since the start of the preparation
    velocity: FloatArray  #: (n, 2)
    angular_velocity: FloatArray  #: (n,)
    pairs: Contacts  #: disk-disk candidates
    walls: Contacts  #: disk-wall candidates
    box: Box  #: what bounds the packing
    load_factor: float = 0.0  #: multiplier of the scene's loads
    reached: Reached = field(default=Reached(), compare=False)  #: how

    @property
    def certificate(self) -> Certificate:
        """What the state guarantees; raises ``ValueError`` when nothing was measured."""
        if self.reached.certificate is None:
            raise ValueError("a state without a certificate")
        return self.reached.certificate

    def pair_separation(self) -> FloatArray:
        """(m, 2) from the centres of ``second`` to those of ``first``."""
        return self.box.separation(self.position[self.pairs.first], self.position[self.pairs.second])

    def pair_normal(self) -> FloatArray:
        """(m, 2) unit normals of the disk-disk candidates, from ``second`` to ``first``."""
        d = self.pair_separation()
        return d / np.linalg.norm(d, axis=1, keepdims=True)

    def pair_force(self) -> FloatArray:
        """(m, 2) force on ``pairs.first``."""
        return contact_force(self.pair_normal(), self.pairs.normal_force, self.pairs.tangential_force)

    def wall_force(self) -> FloatArray:
        """(w, 2) force on ``walls.first``."""
        return contact_force(wall_normals(self.walls.second), self.walls.normal_force, self.walls.tangential_force)

    def largest_normal_force(self) -> FloatArray:
        """(n,) of the contacts of each disk, 0 without any (mean weights)."""
        largest = np.zeros(len(self.position))
        pairs, walls = self.pairs, self.walls
        for disk, contacts in ((pairs.first, pairs), (pairs.second, pairs), (walls.first, walls)):
            np.maximum.at(largest, disk, contacts.normal_force)
        return largest

    def contact_count(
        self, pairs: NDArray[np.bool_] | None = None, *, walls: bool | NDArray[np.bool_] = True
    ) -> NDArray[np.intp]:
        """(n,) closed contacts of each disk. Two are the least that hold one under gravity.

        ``pairs`` (m,), ``walls`` (w,), or for all : those that count; by default all that touch.
        """
        live = self.pairs.touching if pairs is None else pairs
        at_wall = self.walls.first[self.walls.touching & walls]
        sides = (self.pairs.first[live], self.pairs.second[live], at_wall)
        return np.bincount(np.concatenate(sides), minlength=len(self.position))

    def __repr__(self) -> str:
        return (
            f"State({len(self.position)} disks at load factor {self.load_factor:g}, "
            f"pairs={self.pairs!r}, walls={self.walls!r}, box={self.box!r})"
        )


def contact_force(normal: FloatArray, normal_force: FloatArray, tangential_force: FloatArray) -> FloatArray:
    """(..., m, 2) forces from their parts along the unit ``normal`` (..., m, 2) and the tangent z × n (eq. 4)."""
    tangent = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
    return normal_force[..., None] * normal + tangential_force[..., None] * tangent
