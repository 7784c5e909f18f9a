"""Where two bodies are: distance, normal and overlap of a contact, for floats or for the ``Lanes`` of several contacts.

The normal points from the second body to the first; that of a wall points inward.
"""

from ..machine.lanes import root
from ..machine.machine_code import kernel


@kernel
def between(dx, dz, reach):
    """Overlap and normal of two disks, ``(dx, dz)`` from the second to the first and ``reach`` the sum of radii."""
    distance = root(dx * dx + dz * dz)
    inverse = 1.0 / distance
    return reach - distance, dx * inverse, dz * inverse


@kernel
def displaced(ux, uz, dx0, dz0, distance0, gap):
    """Separation, distance and overlap of two disks after a relative displacement ``(ux, uz)``.

    From the separation ``(dx0, dz0)``, the distance and the gap before, so that overlaps keep their digits.
    """
    dx, dz = dx0 + ux, dz0 + uz
    distance = root(dx * dx + dz * dz)
    # |d| - |d0| without cancellation
    stretch = (2.0 * (dx0 * ux + dz0 * uz) + ux * ux + uz * uz) / (distance + distance0)
    return dx, dz, distance, -(gap + stretch)


@kernel
def at_wall(ux, uz, nx, nz, gap):
    """Overlap of a disk with a wall after a displacement ``(ux, uz)`` from the ``gap`` before."""
    return -(gap + ux * nx + uz * nz)
