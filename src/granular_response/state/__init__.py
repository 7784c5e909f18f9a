"""What a packing is at one moment: its state, its contacts and their status, its box."""

from .box import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, Box, FloatArray, foot_points, wall_normals
from .events import CONTACT_EVENTS, LOST_EVENTS, ROLLING_EVENTS, Event
from .reached import Certificate, Reached
from .state import Contacts, State, contact_force
from .status import AT_LIMIT, OPEN, SLIDING, STICKING

__all__ = [
    "AT_LIMIT",
    "CONTACT_EVENTS",
    "FLOOR",
    "LEFT_WALL",
    "LOST_EVENTS",
    "OPEN",
    "RIGHT_WALL",
    "ROLLING_EVENTS",
    "SLIDING",
    "STICKING",
    "WALL_NORMAL",
    "Box",
    "Certificate",
    "Contacts",
    "Event",
    "FloatArray",
    "Reached",
    "State",
    "contact_force",
    "foot_points",
    "wall_normals",
]
