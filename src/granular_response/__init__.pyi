# The public names, each from its module: what type checkers read, and what __init__.py looks up.
from . import plot as plot
from . import studies as studies
from . import theory as theory
from .api.event import find_event as find_event
from .api.event_table import Events as Events
from .api.motion import motion as motion
from .api.observables import coordination_number as coordination_number
from .api.observables import elastic_moduli as elastic_moduli
from .api.observables import fabric_tensor as fabric_tensor
from .api.observables import force_distribution as force_distribution
from .api.observables import mobilization as mobilization
from .api.observables import modes as modes
from .api.observables import stiffness_matrix as stiffness_matrix
from .api.observables import work as work
from .api.result import Result as Result
from .api.result import open_result as open_result
from .api.result import solve as solve
from .api.sweep import preparations as preparations
from .api.sweep import sweep as sweep
from .errors import GranularError as GranularError
from .errors import SolveError as SolveError
from .machine.threads import using as threads
from .plot.pictures import PictureError as PictureError
from .scene import ArrayPacking as Arrays
from .scene import Contact as Contact
from .scene import FilePacking as File
from .scene import LaboratoryUnits as LaboratoryUnits
from .scene import Load as Load
from .scene import Motion as Motion
from .scene import PilePacking as Pile
from .scene import PouredPacking as Poured
from .scene import Preparation as Preparation
from .scene import Protocol as Protocol
from .scene import RowSelector as Row
from .scene import Scene as Scene
from .scene import SceneError as SceneError
from .scene import SceneFileError as SceneFileError
from .scene import SlabPacking as Slab
from .scene import Taps as Taps
from .scene import TopSelector as At
from .scene import Wall as Wall
from .solvers.laws import register_law as register_law
from .state import Certificate as Certificate
from .state import Event as Event
from .state import State as State
from .store.export import ExportError as ExportError
from .store.export import export as export
from .store.files import StoreError as StoreError
from .store.result import ResultError as ResultError
from .studies.brackets import Bracket as Bracket
from .studies.brackets import EventNotBracketed as EventNotBracketed
from .sweeps.errors import SweepError as SweepError
from .sweeps.tasks import map_tasks as map_tasks

__version__: str
# those with another name here than in their module
__all__ = ["Arrays", "At", "File", "Pile", "Poured", "Row", "Slab", "threads"]
