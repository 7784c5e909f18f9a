"""What is simulated: frozen, validated descriptions of packing, contacts, walls, loads and protocol.

``Scene`` is the whole; ``Scene.from_yaml`` reads a scene file and ``scene.packing.build()`` makes the arrays
of its packing. No mechanics here: what the disks do under these loads is for ``granular_response.solve``.
Whatever is wrong with a scene is a ``SceneError``: one line with the key, the value and what is allowed.
"""

from .arrays import ArrayPacking
from .errors import SceneError, SceneFileError
from .laboratory import LaboratoryUnits
from .lattice import PilePacking, SlabPacking
from .load import Load, RowSelector, TopSelector, resolve_disk
from .material import Contact, Wall
from .motion import Motion
from .packing import Packing
from .poured import PouredPacking
from .protocol import Preparation, Protocol, Taps
from .scene import Scene
from .table import FilePacking

__all__ = [
    "ArrayPacking",
    "Contact",
    "FilePacking",
    "LaboratoryUnits",
    "Load",
    "Motion",
    "Packing",
    "PilePacking",
    "PouredPacking",
    "Preparation",
    "Protocol",
    "RowSelector",
    "Scene",
    "SceneError",
    "SceneFileError",
    "SlabPacking",
    "Taps",
    "TopSelector",
    "Wall",
    "resolve_disk",
]
