"""The part of a contact along the tangent (Sec. III.A): a spring and a dashpot under the Coulomb limit.

Arguments are floats, or the ``Lanes`` of several contacts; ``law`` is any law of :mod:`.law`.
"""

from ..machine.lanes import magnitude, quotient_where, select
from ..machine.machine_code import kernel

#: How the Coulomb limit acts on the tangential spring.
CUT, LITERAL, UNLOADING = 0, 1, 2

#: By the name that a scene file has for them.
RULES = {"cut": CUT, "literal": LITERAL, "unloading": UNLOADING}


@kernel
def cut_force(spring, slip_velocity, force_normal, stiffness, damping, friction, time_step):
    """Spring plus dashpot cut to the Coulomb limit; returns force and new spring.

    The limit is ``friction * |force_normal|`` with the dashpot's part included. Where it acts, the stored
    spring becomes the one that gives the cut force, so that the contact sticks again from there.
    """
    trial = spring + slip_velocity * time_step
    damped = damping * slip_velocity
    force = -stiffness * trial - damped
    limit = friction * magnitude(force_normal)
    cut = select(force > limit, limit, force)
    cut = select(cut < -limit, -limit, cut)
    return cut, quotient_where(cut != force, -(cut + damped), stiffness, trial)


@kernel
def tangential_cut(spring, slip_velocity, force_normal, law, time_step):
    """:func:`cut_force` along the tangent."""
    stiffness, damping = law.tangential_stiffness, law.tangential_damping
    return cut_force(spring, slip_velocity, force_normal, stiffness, damping, law.friction, time_step)


@kernel
def tangential_literal(spring, slip_velocity, force_normal, law, time_step):
    """The paper's equation for the spring taken literally: it is frozen while k_T|s| exceeds mu |f_N|.

    The force itself is not cut, and a frozen spring stays frozen on unloading too: kept to show that this
    reading does not settle.
    """
    free = law.friction * magnitude(force_normal) - law.tangential_stiffness * magnitude(spring) > 0.0
    new = spring + select(free, slip_velocity * time_step, 0.0)
    return -law.tangential_stiffness * new - law.tangential_damping * slip_velocity, new


@kernel
def tangential_unloading(spring, slip_velocity, force_normal, law, time_step):
    """As :func:`tangential_literal`, but the spring is frozen only against slip that would stretch it further.

    Between the paper's equation and its words: the spring is kept from growing at the limit, and a contact that
    unloads sticks at once. The force is not cut: where the normal force falls it stays beyond the limit.
    """
    within = law.friction * magnitude(force_normal) - law.tangential_stiffness * magnitude(spring) > 0.0
    moved = slip_velocity * time_step
    new = spring + select(within, moved, select(spring * slip_velocity < 0.0, moved, 0.0))
    return -law.tangential_stiffness * new - law.tangential_damping * slip_velocity, new


@kernel
def tangential(spring, slip_velocity, force_normal, law, rule, time_step):
    """Tangential force and new spring by ``rule``: CUT, LITERAL or UNLOADING."""
    if rule != CUT:
        if rule == LITERAL:
            return tangential_literal(spring, slip_velocity, force_normal, law, time_step)
        return tangential_unloading(spring, slip_velocity, force_normal, law, time_step)
    return tangential_cut(spring, slip_velocity, force_normal, law, time_step)


@kernel
def return_map(trial, limit, stiffness):
    """Force, spring and sense of sliding (0: sticks) for a spring stretched to ``trial`` under a Coulomb ``limit``.

    Along the rolling too, where the limit is that of rolling and the sense that in which the contact rolls.
    """
    force = -stiffness * trial
    if abs(force) <= limit:
        return force, trial, 0.0
    sense = 1.0 if force > 0.0 else -1.0
    force = sense * limit
    return force, -force / stiffness, sense
