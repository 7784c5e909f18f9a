"""What a packing is at one moment: positions, contacts and their status, how it was reached, and what it guarantees.

Observables, datasets and restarts read this one description. Units are the reduced ones (mean disk radius, mean disk
mass, g); the sign conventions are those of ``docs/architecture.md``. Arrays are never modified once a state exists.
What a method does not know of a state is ``None`` in its records.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from .box import Box, FloatArray, wall_normals
from .events import Event

#: Part of its limit by which a force may be below it and count as at the limit.
AT_LIMIT = 1e-9

#: Not in touch; in touch within the Coulomb limit (or without friction); at the Coulomb limit.
OPEN, STICKING, SLIDING = 0, 1, 2
#: Their names, in order.
MEANINGS = ("open", "sticking", "sliding")

#: Names of force, spring and status in each row of a contact: along the tangent, and along the rolling.
ROWS = (("tangential_force", "spring", "status"), ("rolling_force", "rolling_spring", "rolling_status"))
#: Names in a certificate of how far a force is beyond its limit, in each row.
EXCESSES = ("coulomb_excess", "rolling_excess")

#: Part of what a disk bears that may be out of balance.
BALANCED = 1e-6


@dataclass(frozen=True)
class Certificate:
    """What a static state guarantees, measured on the state itself.

    ``force_residual``, ``torque_residual``: largest on any disk (mean weights, mean radii). ``coulomb_excess``:
    largest ``|f_t| - friction f_n``. ``smallest_normal_force``: over closed contacts. ``kinetic_energy``: per
    disk. ``negative_modes``: number of unstable modes with the recorded statuses (where contacts slide 1 stands for any
    number; None: not determined). ``loose_disks``: disks with fewer than two contacts.
    ``unbalanced_part``: largest unbalanced force on a disk, or torque per radius, relative to its weight or its largest
    contact force (nan: not measured).
    ``rolling_excess``: largest rolling force beyond its limit. ``undetermined``: disks of which forces do not determine
    the place or the turn, since a motion moves them that nothing resists, such as a disk without contacts, one that
    rolls on the floor, or disks that roll on each other like gears. They are where the least motion leaves them; the
    forces of the state do not depend on it. Looked for wherever ``negative_modes`` is determined. Turns of disks whose
    contacts all slide, and a packing that nothing holds along x as a whole, do not count.

    Examples
    --------
    >>> result.certificate.stable, result.certificate.force_residual < 1e-9
    (True, True)
    """

    force_residual: float
    torque_residual: float
    coulomb_excess: float
    smallest_normal_force: float
    kinetic_energy: float
    negative_modes: int | None
    loose_disks: int
    unbalanced_part: float = float("nan")
    rolling_excess: float = 0.0
    undetermined: tuple[int, ...] = ()

    @property
    def balanced(self) -> bool:
        """Whether forces and torques on each disk cancel, up to 1e-6 of its weight or largest contact force."""
        return not self.unbalanced_part > BALANCED

    @property
    def stable(self) -> bool | None:
        """Whether the packing is in balance and no direction is unstable; None where that was not determined."""
        if not self.balanced:
            return False
        return None if self.negative_modes is None else self.negative_modes == 0


@dataclass(frozen=True)
class Reached:
    """How a state was reached.

    Reduced units; ``kinetic_energy`` is per disk, before the static finish. ``network_fixed_steps``,
    ``sliding_contacts`` and ``mean_acceleration`` are the further criteria of Sec. III.C, as they were when the
    kinetic energy had fallen below its limit.
    """

    method: str | None = None  #: dynamics, minimise, path or statics
    certificate: Certificate | None = None
    settled: bool | None = None  #: whether dynamics came to rest; False when its steps ran out
    steps: int | None = None  #: time steps of the dynamics since it began
    time_step: float | None = None  #: of the dynamics
    first_steps: int | None = None  #: of ``steps`` those of the first part of a long fall, which has a shorter step
    first_time_step: float | None = None  #: of that part
    time: float | None = None  #: since the last ramp began
    rebuilds: int | None = None  #: times that candidate contacts were listed again
    kinetic_energy: float | None = None
    relaxation_steps: int | None = None  #: time steps of the last relaxation
    network_fixed_steps: int | None = None  #: time steps in which no contact opened or closed
    sliding_contacts: int | None = None
    mean_acceleration: float | None = None  #: of disks with two contacts or more, in units of g
    loose_disks: int | None = None  #: disks with fewer than two contacts
    #: of these, disks that still rolled when the others were at rest, and were stopped by hand; None for none
    stopped_rattlers: int | None = None
    more_relaxations: int | None = None  #: stretches of dynamics between tries of the static finish
    newton_iterations: int | None = None
    finish_displacement: float | None = None  #: largest of a disk in the static finish (mean radii)
    escapes: int | None = None  #: saddles of the energy that were left
    increments: int | None = None  #: of the path so far
    factorisations: int | None = None  #: of the path so far
    events: tuple[Event, ...] = ()  #: of the path since the state before
    events_within: float | None = None  #: load within which a path took events together (mean weights)
    events_error: float | None = None  #: estimate of what that leaves out since then of a floor or wall force

    def after(self, earlier: Reached) -> Reached:
        """This record, and what only the one ``earlier`` knows."""
        return replace(earlier, **{name: value for name, value in vars(self).items() if value not in (None, ())})


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
        for name, kind in zip(ROWS[1], (float, float, np.int8), strict=True):
            if getattr(self, name) is None:
                object.__setattr__(self, name, np.zeros(len(self.first), kind))

    @classmethod
    def of(cls, first, second, overlap, normal_force, forces, springs, statuses) -> Contacts:
        """From ``forces``, ``springs`` and ``statuses`` (r, m) of the first rows, with zeros in the others."""
        rows = zip(forces, springs, np.asarray(statuses, np.int8), strict=True)
        bodies = np.asarray(first, np.int32), np.asarray(second, np.int32)
        return cls(*bodies, overlap, normal_force, *(part for row in rows for part in row))

    @property
    def forces(self) -> FloatArray:
        """(2, m) forces in each row."""
        return np.stack([self.tangential_force, self.rolling_force])

    @property
    def springs(self) -> FloatArray:
        """(2, m) springs in each row."""
        return np.stack([self.spring, self.rolling_spring])

    @property
    def statuses(self) -> NDArray[np.int8]:
        """(2, m) statuses in each row."""
        return np.stack([self.status, self.rolling_status])

    @property
    def touching(self) -> NDArray[np.bool_]:
        """(m,) whether the contact is closed."""
        return self.status != OPEN

    @property
    def sliding(self) -> NDArray[np.bool_]:
        """(m,) whether the contact is at the Coulomb limit."""
        return self.status == SLIDING

    @property
    def rows(self) -> int:
        """Rows of :data:`ROWS` that are in use: two where some contact rolls against a resistance."""
        return 1 + bool((self.rolling_status != OPEN).any())

    def near_limit(self, friction: float, margin: float) -> NDArray[np.bool_]:
        """(m,) whether the contact is closed with ``|f_t| >= (1 - margin) friction f_n``; none without friction."""
        limit = (1.0 - margin) * friction * self.normal_force
        return self.touching & (np.abs(self.tangential_force) >= limit) & (friction > 0.0)

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

    def couples(self, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) and (w,) couples of rolling resistance on the first bodies; ``radius`` (n,) : of the disks."""
        pairs, walls = self.pairs, self.walls
        arms = reduced_radii(radius[pairs.first], radius[pairs.second]), reduced_radii(radius[walls.first])
        return arms[0] * pairs.rolling_force, arms[1] * walls.rolling_force

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


def reduced_radii(first, second=None) -> FloatArray:
    """(m,) ``R_i R_j / (R_i + R_j)`` of disks with radii ``first`` and ``second``; ``R_i`` at a wall (None)."""
    return np.array(first, float) if second is None else first * second / (first + second)
