"""Quasi-static response of two-dimensional granular solids to a localized force.

What stands in ``__all__`` is the public namespace: it keeps its names and meanings, and what they load is loaded on
first use. Everything below it may change from version to version.

``Scene`` says what is simulated, ``solve`` settles and loads it, and a ``Result`` holds what came of it: states,
certificates, events, floor response, contacts, stress. ``plot`` draws results, ``open_result`` reads a stored one.
``sweep`` solves a scene with many values of its keys, ``find_event`` finds where something happens. Everything that
goes wrong is a ``GranularError``.

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
    from .api.event import find_event as find_event
    from .api.result import Result as Result
    from .api.result import open_result as open_result
    from .api.result import solve as solve
    from .api.sweep import sweep as sweep
    from .errors import GranularError as GranularError
    from .errors import SolveError as SolveError
    from .scene import Scene as Scene
    from .scene import SceneError as SceneError
    from .solvers.laws import register_law as register_law
    from .state import Event as Event
    from .store.files import StoreError as StoreError
    from .store.result import ResultError as ResultError
    from .sweeps.errors import SweepError as SweepError

#: Where the public names are; those of "" are modules.
_HOME = {
    "Event": "state",
    "GranularError": "errors",
    "Result": "api.result",
    "ResultError": "store.result",
    "Scene": "scene",
    "SceneError": "scene",
    "SolveError": "errors",
    "StoreError": "store.files",
    "SweepError": "sweeps.errors",
    "find_event": "api.event",
    "open_result": "api.result",
    "plot": "",
    "register_law": "solvers.laws",
    "solve": "api.result",
    "sweep": "api.sweep",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = _HOME[name]
    value = getattr(import_module(f".{home}", __name__), name) if home else import_module(f".{name}", __name__)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})


__all__ = ["__version__", *_HOME]
