"""What a contact law is: a named tuple of its constants, with methods for the part along the normal.

Along the tangent all laws have the spring, the dashpot and the Coulomb limit of :mod:`.coulomb`, with the constants
``tangential_stiffness``, ``tangential_damping`` and ``friction``. ``normal_stiffness`` is the stiffness at a normal
force of one mean disk weight. ``least_force`` bounds the normal force of a closed contact from below: ``-inf`` lets
the dashpot pull for a moment, as eq. (2) says; ``0`` cuts that off.

Arguments are floats, or the ``Lanes`` of several contacts. ``shape`` is the number that a law needs of the two bodies,
as its method ``shapes`` makes it, and None for a law that needs none; ``self`` is the law.
"""

from __future__ import annotations

from typing import Protocol, Self

from numpy.typing import NDArray

from ..machine.lanes import select
from ..machine.machine_code import by_type, kernel
from .coulomb import tangential


class Law(Protocol):
    """One contact law."""

    @property
    def normal_stiffness(self) -> float: ...
    @property
    def normal_damping(self) -> float: ...
    @property
    def tangential_stiffness(self) -> float: ...
    @property
    def tangential_damping(self) -> float: ...
    @property
    def friction(self) -> float: ...
    @property
    def least_force(self) -> float: ...

    # A law that has a text ``only_motion`` is solved by dynamics to the end; the text says why.

    @classmethod
    def of(
        cls, normal_stiffness: float, normal_damping: float, tangential_stiffness: float, tangential_damping: float,
        friction: float, least_force: float, reduced_radius: float, /,
    ) -> Self:  # fmt: skip
        """The law from its constants; ``reduced_radius`` is that of the contacts that have the stiffness.

        A law with parameters of its own takes them by name after these.
        """

    def elastic_force(self, overlap, shape): ...
    def stiffness(self, overlap, shape): ...
    def energy(self, overlap, shape): ...

    def shapes(self, first, second) -> NDArray | None:
        """(m,) geometry factors of contacts of disks with the radii ``first`` and ``second`` (None: a wall).

        None for a law in which radii do not matter.
        """

    def stiffest(self, force: float) -> float:
        """Largest normal stiffness at normal forces up to ``force``."""


def without_friction(law: Law) -> Law:
    """The same law without its part along the tangent."""
    return law._replace(tangential_stiffness=0.0, tangential_damping=0.0, friction=0.0)  # type: ignore[attr-defined]


@by_type
def elastic_force(self, overlap, shape):
    """Normal force of a closed contact at rest (mean disk weights)."""


@by_type
def stiffness(self, overlap, shape):
    """Derivative of :func:`elastic_force` with respect to the overlap."""


@by_type
def energy(self, overlap, shape):
    """Elastic energy of the normal part of a closed contact: the integral of :func:`elastic_force`."""


@kernel
def normal_force(overlap, shape, approach_velocity, law):
    """Normal force in motion, eq. (2): spring plus dashpot; ``approach_velocity`` is v·n, positive in separation."""
    force = elastic_force(law, overlap, shape) - law.normal_damping * approach_velocity
    return select(force > law.least_force, force, law.least_force)


# A contact that is open feels nothing and forgets its spring, which takes no branch. ``normal`` is its force were it
# closed.
@kernel
def frictionless(overlap, nx, nz, normal):
    """Force ``(fx, fz)`` of a contact with the normal ``(nx, nz)`` on its first body."""
    fn = select(overlap > 0.0, normal, 0.0)
    return fn * nx, fn * nz


@kernel
def frictional(overlap, nx, nz, normal, slip_velocity, spring, law, rule, dt):
    """The same, its tangential part, and the new tangential spring: ``(fx, fz, ft, spring)``.

    ``rule`` : of :mod:`.coulomb`; ``dt`` : time step of the spring.
    """
    ft, new = tangential(spring, slip_velocity, normal, law, rule, dt)
    closed = overlap > 0.0
    fn = select(closed, normal, 0.0)
    ft = select(closed, ft, 0.0)
    return fn * nx - ft * nz, fn * nz + ft * nx, ft, select(closed, new, 0.0)
