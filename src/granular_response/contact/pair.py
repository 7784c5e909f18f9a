"""The force between two disks (Sec. III.A) from their relative position and motion.

Arguments and results are scalars, or the ``Lanes`` of several pairs or scenes. A pair that does not touch feels
nothing and forgets its spring; that takes no branch.
"""

from __future__ import annotations

from ..machine.lanes import root, select
from ..machine.machine_code import kernel
from .linear import LITERAL, normal_force, tangential_cut, tangential_literal


@kernel
def frictionless_pair(dx, dz, du, dw, reach, law):
    """Force ``(fx, fz)`` on the first disk.

    ``dx``, ``dz``, ``du``, ``dw`` : position and velocity of the first disk relative to the second; ``reach`` : sum of
    the radii; ``law`` : see ``contact.linear``.
    """
    distance = root(dx * dx + dz * dz)
    inverse = 1.0 / distance
    nx = dx * inverse
    nz = dz * inverse
    overlap = reach - distance
    fn = select(overlap > 0.0, normal_force(overlap, du * nx + dw * nz, law), 0.0)
    return fn * nx, fn * nz


@kernel
def frictional_pair(dx, dz, du, dw, rims, reach, spring, law, rule, dt):
    """Force on the first disk, tangential force, and the new tangential spring: ``(fx, fz, ft, spring)``.

    ``rims`` : sum of radius times angular velocity of both; ``rule`` : CUT or LITERAL; ``dt`` : time step of the
    spring; other arguments as of :func:`frictionless_pair`.
    """
    distance = root(dx * dx + dz * dz)
    inverse = 1.0 / distance
    nx = dx * inverse
    nz = dz * inverse
    overlap = reach - distance
    fn = normal_force(overlap, du * nx + dw * nz, law)
    slip = dw * nx - du * nz - rims
    if rule == LITERAL:
        ft, new = tangential_literal(spring, slip, fn, law, dt)
    else:
        ft, new = tangential_cut(spring, slip, fn, law, dt)
    closed = overlap > 0.0
    fn = select(closed, fn, 0.0)
    ft = select(closed, ft, 0.0)
    return fn * nx - ft * nz, fn * nz + ft * nx, ft, select(closed, new, 0.0)
