"""The contact law of Sec. III.A for one contact.

The law's constants travel as one tuple
``(normal_stiffness, normal_damping, tangential_stiffness, tangential_damping, friction, least_force)``.
``least_force`` bounds the normal force of a closed contact from below: ``-inf`` lets the dashpot pull for a
moment, as eq. (2) says; ``0`` cuts that off. An argument is a float, or the ``Lanes`` of several contacts or
scenes.
"""

from __future__ import annotations

from ..machine.lanes import magnitude, quotient_where, select
from ..machine.machine_code import kernel

#: How the Coulomb limit acts on the tangential spring.
CUT, LITERAL = 0, 1


@kernel(inline="never")
def normal_force(overlap, approach_velocity, law):
    """Eq. (2): spring plus dashpot of a closed contact; ``approach_velocity`` is v·n, positive in separation."""
    force = law[0] * overlap - law[1] * approach_velocity
    return select(force > law[5], force, law[5])


@kernel
def tangential_cut(spring, slip_velocity, force_normal, law, time_step):
    """Spring plus dashpot cut to the Coulomb limit; returns force and new spring.

    The limit is ``friction * |force_normal|`` with the dashpot's part included. Where it acts, the stored
    spring becomes the one that gives the cut force, so that the contact sticks again from there.
    """
    trial = spring + slip_velocity * time_step
    damping = law[3] * slip_velocity
    force = -law[2] * trial - damping
    limit = law[4] * magnitude(force_normal)
    cut = select(force > limit, limit, force)
    cut = select(cut < -limit, -limit, cut)
    return cut, quotient_where(cut != force, -(cut + damping), law[2], trial)


@kernel
def tangential_literal(spring, slip_velocity, force_normal, law, time_step):
    """The paper's equation for the spring taken literally: it is frozen while k_T|s| exceeds mu |f_N|.

    The force itself is not cut, and a frozen spring stays frozen on unloading too: kept to show that this
    reading does not settle.
    """
    free = law[4] * magnitude(force_normal) - law[2] * magnitude(spring) > 0.0
    new = spring + select(free, slip_velocity * time_step, 0.0)
    return -law[2] * new - law[3] * slip_velocity, new
