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
    rolling: Any  #: contact.rolling.Rolling
    couple: Floats | None = None  #: (n,) scratch for the couples of pairs; None at walls


class Pairs(NamedTuple):
    """Candidate contacts between disks, in slots (see :mod:`.forces`)."""

    runs: NDArray[Any]  #: (r, 4) int64, those of count one last
    dx: Floats  #: (slots,) reference separations
    dz: Floats
    reach: Floats  #: (slots,) sums of radii; 0 in slots of no listed pair
    shape: Floats | None  #: (slots,) what the law needs of the radii
    spring: Floats | None  #: (slots,) tangential springs, updated in place; None without friction
    scratch: Floats  #: (SCRATCH,)
    law: Any  #: a named tuple of ``contact``


class Walls(NamedTuple):
    """Candidate contacts of disks with floor and side walls."""

    disk: NDArray[Any]  #: (w,)
    normal: Floats  #: (w, 2) inward
    gap: Floats  #: (w,) reference gaps
    shape: Floats | None  #: (w,)
    spring: Floats | None  #: (w,)
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
    pair_rolls: Rolls | None = None  #: None without rolling resistance
    wall_rolls: Rolls | None = None


class Schedule(NamedTuple):
    """Linear ramps of gravity and load; ``time`` is the time since they began."""

    time: float
    gravity_from: float
    gravity_to: float
    gravity_time: float
    load_from: float
    load_to: float
    load_time: float
