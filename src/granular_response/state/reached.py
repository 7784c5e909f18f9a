"""How a state was reached, and what it guarantees: typed records, ``None`` where a method does not know."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from .events import Event

#: Part of what a disk bears that may be out of balance.
BALANCED = 1e-6


@dataclass(frozen=True)
class Certificate:
    """What a static state guarantees, measured on the state itself.

    ``force_residual``, ``torque_residual``: largest on any disk (mean weights, mean radii). ``coulomb_excess``:
    largest ``|f_t| - friction f_n``. ``smallest_normal_force``: over closed contacts. ``kinetic_energy``: per
    disk. ``negative_modes``: number of unstable modes with the recorded statuses (where contacts slide 1 stands for any
    number; None: not determined). ``loose_disks``: disks with fewer than two contacts.
    ``unbalanced_part``: largest unbalanced force on a disk, or torque per radius, relative to its weight or its largest
    contact force (nan: not measured).
    ``rolling_excess``: largest rolling force beyond its limit.

    Examples
    --------
    >>> result.certificate.stable, result.certificate.force_residual < 1e-9
    (True, True)
    """

    force_residual: float
    torque_residual: float
    coulomb_excess: float
    smallest_normal_force: float
    kinetic_energy: float
    negative_modes: int | None
    loose_disks: int
    unbalanced_part: float = float("nan")
    rolling_excess: float = 0.0

    @property
    def balanced(self) -> bool:
        """Whether forces and torques on each disk cancel, up to 1e-6 of its weight or largest contact force."""
        return not self.unbalanced_part > BALANCED

    @property
    def stable(self) -> bool | None:
        """Whether the packing is in balance and no direction is unstable; None where that was not determined."""
        if not self.balanced:
            return False
        return None if self.negative_modes is None else self.negative_modes == 0


@dataclass(frozen=True)
class Reached:
    """How a state was reached.

    Reduced units; ``kinetic_energy`` is per disk, before the static finish. ``network_fixed_steps``,
    ``sliding_contacts`` and ``mean_acceleration`` are the further criteria of Sec. III.C, as they were when the
    kinetic energy had fallen below its limit.
    """

    method: str | None = None  #: dynamics, minimise, path or statics
    certificate: Certificate | None = None
    settled: bool | None = None  #: whether dynamics came to rest; False when its steps ran out
    steps: int | None = None  #: time steps of the dynamics since it began
    time_step: float | None = None  #: of the dynamics
    time: float | None = None  #: since the last ramp began
    rebuilds: int | None = None  #: times that candidate contacts were listed again
    kinetic_energy: float | None = None
    relaxation_steps: int | None = None  #: time steps of the last relaxation
    network_fixed_steps: int | None = None  #: time steps in which no contact opened or closed
    sliding_contacts: int | None = None
    mean_acceleration: float | None = None  #: of disks with two contacts or more, in units of g
    loose_disks: int | None = None  #: disks with fewer than two contacts
    #: of these, disks that still rolled when the others were at rest, and were stopped by hand; None for none
    stopped_rattlers: int | None = None
    more_relaxations: int | None = None  #: stretches of dynamics between tries of the static finish
    newton_iterations: int | None = None
    finish_displacement: float | None = None  #: largest of a disk in the static finish (mean radii)
    escapes: int | None = None  #: saddles of the energy that were left
    increments: int | None = None  #: of the path so far
    factorisations: int | None = None  #: of the path so far
    events: tuple[Event, ...] = ()  #: of the path since the state before
    events_within: float | None = None  #: load within which a path took events together (mean weights)
    events_error: float | None = None  #: estimate of what that leaves out since then of a floor or wall force

    def after(self, earlier: Reached) -> Reached:
        """This record, and what only the one ``earlier`` knows."""
        known = {field.name: getattr(self, field.name) for field in fields(self)}
        return replace(earlier, **{name: value for name, value in known.items() if value not in (None, ())})
