"""What a packing is at one moment: its state, its contacts and their status, its box."""

from .box import FLOOR as FLOOR
from .box import LEFT_WALL as LEFT_WALL
from .box import RIGHT_WALL as RIGHT_WALL
from .box import WALL_NORMAL as WALL_NORMAL
from .box import Box as Box
from .box import FloatArray as FloatArray
from .box import foot_points as foot_points
from .box import wall_normals as wall_normals
from .events import CONTACT_EVENTS as CONTACT_EVENTS
from .events import LOST_EVENTS as LOST_EVENTS
from .events import MOVED_FAR as MOVED_FAR
from .events import ROW_EVENTS as ROW_EVENTS
from .events import Event as Event
from .index import StateIndexError as StateIndexError
from .index import state_index as state_index
from .state import AT_LIMIT as AT_LIMIT
from .state import OPEN as OPEN
from .state import EXCESSES as EXCESSES
from .state import ROWS as ROWS
from .state import SLIDING as SLIDING
from .state import STICKING as STICKING
from .state import Certificate as Certificate
from .state import Contacts as Contacts
from .state import Reached as Reached
from .state import State as State
from .state import contact_force as contact_force
