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
def cut(spring, slip_velocity, force_normal, stiffness, damping, friction, time_step):
    """Spring plus dashpot cut to a Coulomb limit; returns force and new spring.

    The limit is ``friction * |force_normal|`` with the dashpot's part included. Where it acts, the stored
    spring becomes the one that gives the cut force, so that the contact sticks again from there. Along the rolling too.
    """
    trial = spring + slip_velocity * time_step
    damped = damping * slip_velocity
    force = -stiffness * trial - damped
    limit = friction * magnitude(force_normal)
    kept = select(force > limit, limit, force)
    kept = select(kept < -limit, -limit, kept)
    return kept, quotient_where(kept != force, -(kept + damped), stiffness, trial)


@kernel
def tangential_frozen(spring, slip_velocity, force_normal, law, rule, time_step):
    """The paper's equation for the spring: it is frozen while k_T|s| exceeds mu |f_N|, and the force is not cut.

    LITERAL is the equation taken literally: a frozen spring stays frozen on unloading too, kept to show that this
    reading does not settle. UNLOADING lies between it and the paper's words: the spring is frozen only against slip
    that would stretch it further, and a contact that unloads sticks at once; where the normal force falls the
    tangential force stays beyond the limit.
    """
    moves = law.friction * magnitude(force_normal) - law.tangential_stiffness * magnitude(spring) > 0.0
    if rule == UNLOADING:
        moves = moves | (spring * slip_velocity < 0.0)
    new = spring + select(moves, slip_velocity * time_step, 0.0)
    return -law.tangential_stiffness * new - law.tangential_damping * slip_velocity, new


@kernel
def tangential(spring, slip_velocity, force_normal, law, rule, time_step):
    """Tangential force and new spring by ``rule``: CUT, LITERAL or UNLOADING."""
    if rule != CUT:
        return tangential_frozen(spring, slip_velocity, force_normal, law, rule, time_step)
    return cut(
        spring, slip_velocity, force_normal, law.tangential_stiffness, law.tangential_damping, law.friction, time_step
    )


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
