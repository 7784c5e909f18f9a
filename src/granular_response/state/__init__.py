"""What a packing is at one moment: its state, its contacts and their status, its box."""

from .box import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, Box, FloatArray, foot_points, wall_normals
from .reached import Certificate, Crossing, Reached
from .state import Contacts, State, contact_force
from .status import OPEN, SLIDING, STICKING

__all__ = [
    "FLOOR",
    "LEFT_WALL",
    "OPEN",
    "RIGHT_WALL",
    "SLIDING",
    "STICKING",
    "WALL_NORMAL",
    "Box",
    "Certificate",
    "Contacts",
    "Crossing",
    "FloatArray",
    "Reached",
    "State",
    "contact_force",
    "foot_points",
    "wall_normals",
]
