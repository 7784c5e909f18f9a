"""The part of a contact along the tangent (Sec. III.A): a spring and a dashpot under the Coulomb limit.

Arguments are floats, or the ``Lanes`` of several contacts; ``law`` is any law of :mod:`.law`.
"""

from ..machine.lanes import magnitude, quotient_where, select
from ..machine.machine_code import by_type, kernel

#: How the Coulomb limit acts on the tangential spring.
CUT, LITERAL, UNLOADING = 0, 1, 2

#: By the name that a scene file has for them.
RULES = {"cut": CUT, "literal": LITERAL, "unloading": UNLOADING}


@by_type
def limit(self, force_normal):
    """Largest tangential force of a contact that presses with ``force_normal``; Coulomb's, unless a law has its own."""
    return self.friction * force_normal


@by_type
def limit_slope(self, force_normal):
    """Derivative of :func:`limit` with respect to the normal force."""
    return self.friction


@kernel
def cut(trial, damped, limit, stiffness):
    """Force, new spring, and whether it slides, of a spring stretched to ``trial`` beside a dashpot, under a ``limit``.

    ``damped`` : force of the dashpot against the slip, a part of what the limit cuts; 0 at rest, where this is the
    return map. Where the limit acts, the stored spring becomes the one that gives the cut force, so that the contact
    sticks again from there.
    """
    force = -stiffness * trial - damped
    kept = select(force > limit, limit, force)
    kept = select(kept < -limit, -limit, kept)
    slides = kept != force
    return kept, quotient_where(slides, -kept - damped, stiffness, trial), slides


@kernel
def tangential_frozen(spring, slip_velocity, force_normal, law, rule, time_step):
    """The paper's equation for the spring: it is frozen while k_T|s| exceeds mu |f_N|, and the force is not cut.

    LITERAL is the equation taken literally: a frozen spring stays frozen on unloading too, kept to show that this
    reading does not settle. UNLOADING lies between it and the paper's words: the spring is frozen only against slip
    that would stretch it further, and a contact that unloads sticks at once; where the normal force falls the
    tangential force stays beyond the limit.
    """
    moves = limit(law, magnitude(force_normal)) - law.tangential_stiffness * magnitude(spring) > 0.0
    if rule == UNLOADING:
        moves = moves | (spring * slip_velocity < 0.0)
    new = spring + select(moves, slip_velocity * time_step, 0.0)
    return -law.tangential_stiffness * new - law.tangential_damping * slip_velocity, new


@kernel
def tangential(spring, slip_velocity, force_normal, law, rule, time_step):
    """Force and new spring of a contact that slips for a ``time_step``, by ``rule``: CUT, LITERAL or UNLOADING."""
    if rule != CUT:
        return tangential_frozen(spring, slip_velocity, force_normal, law, rule, time_step)
    damped, most = law.tangential_damping * slip_velocity, limit(law, magnitude(force_normal))
    force, new, _ = cut(spring + slip_velocity * time_step, damped, most, law.tangential_stiffness)
    return force, new
