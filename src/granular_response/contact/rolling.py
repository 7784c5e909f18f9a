"""The part of a contact along the rolling: a spring and a dashpot against relative spin, under a limit of its own.

All laws share it, as they share the part along the tangent; :func:`.coulomb.tangential` is that of both, here at the
velocity of the rolling. With the relative spin ``w = w_i - w_j`` (``w_i`` at a wall) and the reduced radius ``R`` of
:func:`..state.reduced_radii`

    dpsi/dt = R w,    F_r = -k_R psi - nu_R R w,    |F_r| <= mu_R |f_n|,

and the couple ``R F_r`` turns the first body, its opposite the second: no net force. It is the model ``sds`` of LAMMPS
``granular`` (S. Luding, Granular Matter 10, 235, 2008), whose page prints the spring with the other sign.
"""

from __future__ import annotations

from typing import NamedTuple

from ..machine.machine_code import tell_apart


class Rolling(NamedTuple):
    """Constants of the rolling resistance of one kind of contact, k_R, nu_R and mu_R; without friction there is none.

    Named as those that a law has along the tangent, so that what goes through both parts need not know which one it is.
    """

    tangential_stiffness: float = 0.0
    tangential_damping: float = 0.0
    friction: float = 0.0


tell_apart(Rolling)

#: Of contacts that roll freely.
FREE = Rolling()
