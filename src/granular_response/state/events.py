"""What happened between two kept states of a load path."""

from __future__ import annotations

from dataclasses import dataclass

#: What a contact does at an event.
CONTACT_EVENTS = ("opens", "closes", "slides", "sticks", "reverses")
#: What happens to an equilibrium that ends: a longer increment finds the next one nearby, the motion of the disks leads
#: to it, or one of several branches is taken.
LOST_EVENTS = ("stepped over", "jump", "bifurcation")


@dataclass(frozen=True)
class Event:
    """One change on a load path."""

    load_factor: float
    kind: str  #: one of ``CONTACT_EVENTS`` or ``LOST_EVENTS``
    first: int = -1  #: disk; the one that moves farthest where an equilibrium is lost
    second: int = -1  #: the other disk, or the wall; -1 where an equilibrium is lost
    at_wall: bool = False
    x: float = float("nan")  #: of the point of contact, or of the disk
    z: float = float("nan")
    until: float = float("nan")  #: load factor at which the path goes on where an equilibrium is lost
    displacement: float = 0.0  #: largest of a disk on the way from a lost equilibrium to the next (mean radii)
    reason: str = ""  #: why an equilibrium is lost

    @property
    def lost(self) -> bool:
        """Whether an equilibrium ends."""
        return self.kind in LOST_EVENTS
