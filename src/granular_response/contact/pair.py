"""The force of one contact from relative position and motion (Sec. III.A): between disks, or of a disk and a wall.

Arguments and results are scalars, or the ``Lanes`` of several contacts. A contact that is open feels nothing and
forgets its spring; that takes no branch. ``du``, ``dw`` : velocity of the first body relative to the second;
``rims`` : sum of radius times angular velocity of both; ``shape`` : what the law needs of the two bodies
(:mod:`.law`); ``rule`` : of :mod:`.coulomb`; ``dt`` : time step of the spring.
"""

from ..machine.lanes import select
from ..machine.machine_code import kernel
from .coulomb import tangential
from .geometry import between
from .law import normal_force


@kernel
def frictionless(overlap, nx, nz, du, dw, shape, law):
    """Force ``(fx, fz)`` on the first body of a contact with the normal ``n``."""
    fn = select(overlap > 0.0, normal_force(overlap, shape, du * nx + dw * nz, law), 0.0)
    return fn * nx, fn * nz


@kernel
def frictional(overlap, nx, nz, du, dw, rims, shape, spring, law, rule, dt):
    """Force on the first body, tangential force, and the new tangential spring: ``(fx, fz, ft, spring)``."""
    fn = normal_force(overlap, shape, du * nx + dw * nz, law)
    ft, new = tangential(spring, dw * nx - du * nz - rims, fn, law, rule, dt)
    closed = overlap > 0.0
    fn = select(closed, fn, 0.0)
    ft = select(closed, ft, 0.0)
    return fn * nx - ft * nz, fn * nz + ft * nx, ft, select(closed, new, 0.0)


@kernel
def frictionless_pair(dx, dz, du, dw, reach, shape, law):
    """Force on the first of two disks; ``dx``, ``dz`` : from the second to it; ``reach`` : sum of the radii."""
    overlap, nx, nz = between(dx, dz, reach)
    return frictionless(overlap, nx, nz, du, dw, shape, law)


@kernel
def frictional_pair(dx, dz, du, dw, rims, reach, shape, spring, law, rule, dt):
    """As :func:`frictional` for two disks; arguments as of :func:`frictionless_pair`."""
    overlap, nx, nz = between(dx, dz, reach)
    return frictional(overlap, nx, nz, du, dw, rims, shape, spring, law, rule, dt)
