"""What happened between two kept states of a load path."""

from __future__ import annotations

from dataclasses import dataclass

from .box import bodies

#: What a contact does at an event where it stays closed, along the tangent and along the rolling.
ROW_EVENTS = (("slides", "sticks", "reverses"), ("rolls", "stops rolling", "rolls back"))
#: What any contact does.
CONTACT_EVENTS = ("opens", "closes", *ROW_EVENTS[0])
#: What happens to an equilibrium that ends: a longer increment finds the next one nearby, the motion of the disks leads
#: to it, or to one of several.
LOST_EVENTS = ("stepped over", "jump", "bifurcation")

#: Why the next one may have been lost where minima are looked for at chosen loads alone.
MOVED_FAR = "the minimum has moved far"


@dataclass(frozen=True)
class Event:
    """One change on a load path: a contact changes its status, or an equilibrium is lost.

    ``kind`` is, for a contact, ``"opens"``, ``"closes"``, ``"slides"`` (reaches Coulomb's limit), ``"sticks"`` (leaves
    it) or ``"reverses"`` (slides the other way); where it resists rolling also ``"rolls"`` (reaches the limit of that),
    ``"stops rolling"`` or ``"rolls back"``. Where an equilibrium is lost it is ``"stepped over"`` (the next one is
    near, under a slightly larger load), ``"jump"`` (the motion of the disks leads to it) or ``"bifurcation"`` (it is
    unstable, and the motion leads to one of several others). Lengths are in mean disk radii.

    Examples
    --------
    >>> opening = result.events.of("opens")[0]
    >>> opening.kind, 0.0 < opening.load_factor < 1.0
    ('opens', True)
    >>> event = gr.Event(0.25, "opens", first=3, second=1, x=2.0, z=1.0)
    >>> event.lost, event.where
    (False, 'disks 3 and 1')
    """

    load_factor: float  #: multiplier of the scene's loads at which it happens
    kind: str
    first: int = -1  #: disk; the one that moves farthest where an equilibrium is lost, -1 if not recorded
    second: int = -1  #: the other disk, or the wall; -1 where an equilibrium is lost
    at_wall: bool = False
    x: float = float("nan")  #: of the point of contact, or of the disk
    z: float = float("nan")
    until: float = float("nan")  #: load factor at which the path goes on: it happens between the two
    displacement: float = 0.0  #: largest of a disk on the way from a lost equilibrium to the next
    reason: str = ""  #: why an equilibrium is lost

    @property
    def lost(self) -> bool:
        """Whether an equilibrium ends."""
        return self.kind in LOST_EVENTS

    @property
    def where(self) -> str:
        """The disks, or the disk and the wall, for people."""
        if self.first < 0:
            return "unknown disk"
        if self.second < 0:
            return f"disk {self.first}"
        return bodies(self.first, self.second, self.at_wall)
