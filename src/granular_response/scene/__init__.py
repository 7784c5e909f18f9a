"""What is simulated: frozen, validated descriptions of packing, contacts, walls, loads and protocol.

``Scene`` is the whole; ``Scene.from_yaml`` reads a scene file and ``scene.packing.build()`` makes the arrays
of its packing. No mechanics here: what the disks do under these loads is for ``granular_response.solve``.
Whatever is wrong with a scene is a ``SceneError``: one line with the key, the value and what is allowed.
"""

from .arrays import ArrayPacking as ArrayPacking
from .errors import SceneError as SceneError
from .errors import SceneFileError as SceneFileError
from .laboratory import LaboratoryUnits as LaboratoryUnits
from .lattice import PilePacking as PilePacking
from .lattice import SlabPacking as SlabPacking
from .load import Load as Load
from .load import RowSelector as RowSelector
from .load import TopSelector as TopSelector
from .load import resolve_disk as resolve_disk
from .material import Contact as Contact
from .material import Wall as Wall
from .packing import Packing as Packing
from .poured import PouredPacking as PouredPacking
from .protocol import Motion as Motion
from .protocol import Preparation as Preparation
from .protocol import Protocol as Protocol
from .protocol import Taps as Taps
from .scene import Scene as Scene
from .table import FilePacking as FilePacking
