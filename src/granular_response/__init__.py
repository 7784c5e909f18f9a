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

import re
from importlib import import_module
from pkgutil import get_data
from typing import Any

__version__ = "0.1.0"

#: The public names, with their module and their name there, as the stub beside this file imports them.
_HOME = {
    name: (home, own)
    for home, own, name in re.findall(
        r"^from \.(\S*) import (\w+) as (\w+)", (get_data(__name__, "__init__.pyi") or b"").decode(), re.MULTILINE
    )
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home, own = _HOME[name]
    value = getattr(import_module(f".{home}", __name__), own) if home else import_module(f".{own}", __name__)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)


__all__ = ["__version__", *sorted(_HOME)]
