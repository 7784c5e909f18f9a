"""Quasi-static response of two-dimensional granular solids to a localized force.

``Scene`` says what is simulated: a packing (``Slab``, ``Pile``, ``Poured``, or disks of your own by
``Scene.from_arrays``), ``Contact`` and ``Wall`` laws, ``Load`` and ``Protocol``. ``solve`` settles and loads it, and a
``Result`` holds what came of it: states, certificates, events, floor response, contacts, stress. ``plot`` draws it,
``open_result`` reads a stored one, ``sweep`` solves a scene with many values of its keys, ``find_event`` finds where
something happens, ``studies`` has load paths of slabs, ``theory`` predictions to compare with. What goes wrong with a
scene, a file or a solution is a ``GranularError``; a wrong argument of a call may be a ValueError, TypeError or
IndexError, as its docstring says.

What stands in ``__all__`` is the public namespace. It keeps its names and meanings, and is loaded on first use;
everything below it may change from version to version.

>>> import granular_response as gr
>>> result = gr.solve(gr.Scene().updated({"contact.friction": 0.2}))
>>> result.save("result.nc")
>>> gr.plot.response(result).figure.savefig("response.pdf")
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
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
    from .api.preparations import preparations as preparations
    from .api.result import Result as Result
    from .api.result import open_result as open_result
    from .api.result import solve as solve
    from .api.sweep import sweep as sweep
    from .errors import GranularError as GranularError
    from .errors import SolveError as SolveError
    from .machine.threads import using as threads  # noqa: F401
    from .plot.pictures import PictureError as PictureError
    from .scene import ArrayPacking as Arrays  # noqa: F401
    from .scene import Contact as Contact
    from .scene import FilePacking as File  # noqa: F401
    from .scene import LaboratoryUnits as LaboratoryUnits
    from .scene import Load as Load
    from .scene import Motion as Motion
    from .scene import PilePacking as Pile  # noqa: F401
    from .scene import PouredPacking as Poured  # noqa: F401
    from .scene import Preparation as Preparation
    from .scene import Protocol as Protocol
    from .scene import RowSelector as Row  # noqa: F401
    from .scene import Scene as Scene
    from .scene import SceneError as SceneError
    from .scene import SceneFileError as SceneFileError
    from .scene import SlabPacking as Slab  # noqa: F401
    from .scene import Taps as Taps
    from .scene import TopSelector as At  # noqa: F401
    from .scene import Wall as Wall
    from .solvers.laws import register_law as register_law
    from .state import Certificate as Certificate
    from .state import Event as Event
    from .state import State as State
    from .store.export import ExportError as ExportError
    from .store.files import StoreError as StoreError
    from .store.result import ResultError as ResultError
    from .studies.brackets import Bracket as Bracket
    from .studies.brackets import EventNotBracketed as EventNotBracketed
    from .sweeps.errors import SweepError as SweepError
    from .sweeps.tasks import map_tasks as map_tasks

#: Where the public names are: their module, with another name there after a colon; those of "" are modules.
_HOME = {
    "Arrays": "scene:ArrayPacking",
    "At": "scene:TopSelector",
    "Bracket": "studies.brackets",
    "Certificate": "state",
    "Contact": "scene",
    "Event": "state",
    "EventNotBracketed": "studies.brackets",
    "Events": "api.event_table",
    "ExportError": "store.export",
    "File": "scene:FilePacking",
    "GranularError": "errors",
    "LaboratoryUnits": "scene",
    "Load": "scene",
    "Motion": "scene",
    "PictureError": "plot.pictures",
    "Pile": "scene:PilePacking",
    "Poured": "scene:PouredPacking",
    "Preparation": "scene",
    "Protocol": "scene",
    "Result": "api.result",
    "ResultError": "store.result",
    "Row": "scene:RowSelector",
    "Scene": "scene",
    "SceneError": "scene",
    "SceneFileError": "scene",
    "Slab": "scene:SlabPacking",
    "SolveError": "errors",
    "State": "state",
    "StoreError": "store.files",
    "SweepError": "sweeps.errors",
    "Taps": "scene",
    "Wall": "scene",
    "coordination_number": "api.observables",
    "elastic_moduli": "api.observables",
    "fabric_tensor": "api.observables",
    "find_event": "api.event",
    "force_distribution": "api.observables",
    "map_tasks": "sweeps.tasks",
    "mobilization": "api.observables",
    "modes": "api.observables",
    "motion": "api.motion",
    "open_result": "api.result",
    "plot": "",
    "preparations": "api.preparations",
    "register_law": "solvers.laws",
    "solve": "api.result",
    "stiffness_matrix": "api.observables",
    "studies": "",
    "sweep": "api.sweep",
    "theory": "",
    "threads": "machine.threads:using",
    "work": "api.observables",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home, _, own_name = _HOME[name].partition(":")
    value = import_module(f".{home or name}", __name__)
    if home:
        value = getattr(value, own_name or name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)


__all__ = ["__version__", *_HOME]
