"""The part of a contact along the rolling: a spring and a dashpot against relative spin, under a limit of its own.

All laws share it, as they share the part along the tangent (:mod:`.coulomb`). With the relative spin ``w = w_i - w_j``
(``w_i`` at a wall) and the reduced radius ``R = R_i R_j / (R_i + R_j)`` (``R_i`` at a wall; both are full radii)

    dpsi/dt = R w,    F_r = -k_R psi - nu_R R w,    |F_r| <= mu_R |f_n|,

and the couple ``R F_r`` turns the first body, its opposite the second: no net force. It is the model ``sds`` of LAMMPS
``granular`` (S. Luding, Granular Matter 10, 235, 2008), whose page prints the spring with the other sign.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..machine.machine_code import kernel


class Rolling(NamedTuple):
    """Constants of the rolling resistance of one kind of contact."""

    stiffness: float
    damping: float
    friction: float


def arms(first, second=None):
    """(m,) reduced radii of contacts of disks with radii ``first`` and ``second`` (None: a wall)."""
    return np.array(first, float) if second is None else first * second / (first + second)


@kernel
def rolling_force(spring, rolled, normal, rolling, time_step):
    """Rolling force and new spring, ``rolled`` : R w. Where the limit acts, the spring is what the cut force leaves."""
    trial = spring + rolled * time_step
    damping = rolling.damping * rolled
    force = -rolling.stiffness * trial - damping
    limit = rolling.friction * abs(normal)
    if abs(force) <= limit:
        return force, trial
    cut = limit if force > 0.0 else -limit
    return cut, -(cut + damping) / rolling.stiffness
