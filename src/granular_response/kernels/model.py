"""What the kernels are given of a scene: named tuples of arrays, made once for each list of candidate contacts.

``n`` disks, ``slots`` storage places of pairs, ``w`` candidates at walls. Parts of the physics that a scene does not
have are None.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.typing import NDArray

Floats = NDArray[Any]


class Rolls(NamedTuple):
    """Rolling resistance of contacts of one kind, in the places of their other arrays."""

    arm: Floats  #: (slots,) or (w,) reduced radii
    spring: Floats  #: the same; updated in place
    law: Any  #: contact.rolling.Rolling
    couple: Floats | None = None  #: (n,) scratch for the couples of pairs; None at walls


def rows(laws, springs, arm: Floats, couple: Floats | None = None) -> tuple[Floats | None, Rolls | None]:
    """Tangential springs and rolling resistance of one kind of contacts, from its laws and springs row by row.

    None for what has no friction.
    """
    rubs, rolls = (row < len(laws) and laws[row].friction > 0.0 for row in range(2))
    return springs[0] if rubs else None, Rolls(arm, springs[1], laws[1], couple) if rolls else None


def springs_of(kind: Pairs | Walls) -> list[Floats]:
    """Springs of the rows that have friction."""
    rolls = () if kind.rolls is None else (kind.rolls.spring,)
    return [] if kind.spring is None else [kind.spring, *rolls]


class Pairs(NamedTuple):
    """Candidate contacts between disks, in slots (see :mod:`.forces`)."""

    runs: NDArray[Any]  #: (r, 4) int64, those of count one last
    dx: Floats  #: (slots,) reference separations
    dz: Floats
    reach: Floats  #: (slots,) sums of radii; 0 in slots of no listed pair
    shape: Floats | None  #: (slots,) what the law needs of the radii
    spring: Floats | None  #: (slots,) tangential springs, updated in place; None without friction
    rolls: Rolls | None
    scratch: Floats  #: (SCRATCH,)
    law: Any  #: a named tuple of ``contact``


class Walls(NamedTuple):
    """Candidate contacts of disks with floor and side walls."""

    disk: NDArray[Any]  #: (w,)
    normal: Floats  #: (w, 2) inward
    gap: Floats  #: (w,) reference gaps
    shape: Floats | None  #: (w,)
    spring: Floats | None  #: (w,)
    rolls: Rolls | None
    law: Any


class Model(NamedTuple):
    """A scene as the integrators carry it from step to step."""

    n: int
    weight: Floats  #: (n,) multiplied by gravity
    inverse_mass: Floats  #: (dof,) inverse masses and moments of inertia
    radius: Floats  #: (n,)
    rim: Floats | None  #: (n,) scratch for radius times angular velocity; None without rotations
    load: Floats  #: (l, 3) force and torque on the loaded disks, multiplied by the load factor
    load_disk: NDArray[Any]  #: (l,)
    pairs: Pairs
    walls: Walls
    rule: int  #: how the Coulomb limit acts (contact.RULES)


class Motion(NamedTuple):
    """Disks in motion, and the forces on them."""

    n: int
    q: Floats  #: (dof,) displacements
    v: Floats  #: (dof,) velocities
    rim: Floats | None  #: (n,) radius times angular velocity; None without rotations
    f: Floats  #: (dof,) forces, added to
    rule: int
    dt: float  #: time by which springs advance


class Schedule(NamedTuple):
    """Linear ramps of gravity and load; ``time`` is the time since they began."""

    time: float
    gravity_from: float
    gravity_to: float
    gravity_time: float
    load_from: float
    load_to: float
    load_time: float
