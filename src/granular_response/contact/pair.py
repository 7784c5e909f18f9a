"""The force of one contact on its first body (Sec. III.A): between disks, or of a disk and a wall.

Arguments and results are scalars, or the ``Lanes`` of several contacts. A contact that is open feels nothing and
forgets its spring; that takes no branch. ``normal`` : its force were it closed (:func:`.law.normal_force`).
"""

from ..machine.lanes import select
from ..machine.machine_code import kernel
from .coulomb import tangential


@kernel
def frictionless(overlap, nx, nz, normal):
    """Force ``(fx, fz)`` of a contact with the normal ``(nx, nz)``."""
    fn = select(overlap > 0.0, normal, 0.0)
    return fn * nx, fn * nz


@kernel
def frictional(overlap, nx, nz, normal, slip_velocity, spring, law, rule, dt):
    """Force, its tangential part, and the new tangential spring: ``(fx, fz, ft, spring)``.

    ``rule`` : of :mod:`.coulomb`; ``dt`` : time step of the spring.
    """
    ft, new = tangential(spring, slip_velocity, normal, law, rule, dt)
    closed = overlap > 0.0
    fn = select(closed, normal, 0.0)
    ft = select(closed, ft, 0.0)
    return fn * nx - ft * nz, fn * nz + ft * nx, ft, select(closed, new, 0.0)
