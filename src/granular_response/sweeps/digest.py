"""Names made from content: equal values have equal names in every process, others have others.

Where a value cannot be told from another one by what it holds there is no name, so that nothing is kept under it and
nothing of another value is found.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import inspect
import os
import sys
import types
from collections.abc import Iterator, Mapping
from enum import Enum
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from ..scene.base import Description
from ..scene.table import FilePacking

_PACKAGE = Path(__file__).parents[1]


class Indistinct(ValueError):
    """A value that cannot be told from others by its content. One line that names it."""


def digest(*values: Any) -> str:
    """32 hexadecimal digits for values, the same in every process: equal values, equal names.

    Knows numbers, text, arrays, containers, dataclasses, scenes (with the table that they name) and functions: those
    that can be imported by their name and the file they stand in, others (lambdas, of a notebook or of the running
    script) by their code and all that it refers to.

    Raises
    ------
    Indistinct
        For values of any other kind, and for a table that cannot be read.
    """
    state = hashlib.sha256()
    for value in values:
        state.update(_described(value, ()))
    return state.hexdigest()[:32]


@functools.cache
def sources(*parts: str) -> str:
    """Name of the present code of some parts of this package, of all if none is named, and of what computes in it.

    A part is a folder or a file.
    """
    places = [_PACKAGE / part for part in parts] or [_PACKAGE]
    files = sorted(path for place in places for path in (place.rglob("*.py") if place.is_dir() else [place]))
    versions = [metadata.version(package) for package in ("numba", "numpy", "scipy")]
    return digest({path.relative_to(_PACKAGE).as_posix(): path.read_bytes() for path in files}, versions)


def _described(value: Any, within: tuple[int, ...]) -> bytes:
    """Bytes that only an equal value has. ``within`` are the values around it."""
    kind = type(value)
    if id(value) in within:  # a function that calls itself, say: its place among those around says which one
        return f"within:{within.index(id(value))}:".encode()
    around = (*within, id(value))

    def many(values: Any) -> bytes:
        return b"".join(_packed(_described(part, around)) for part in values)

    def mapping(entries: Mapping) -> bytes:
        return b"".join(sorted(_packed(many(entry)) for entry in entries.items()))

    if value is None or value is Ellipsis or kind in (bool, int, str, bytes, complex, range):
        body = repr(value).encode("utf-8", "surrogatepass")
    elif kind is float:
        body = value.hex().encode()
    elif (kind in (np.ndarray, np.memmap) or isinstance(value, np.generic)) and not value.dtype.hasobject:
        body = f"{value.dtype!r}{value.shape}".encode() + value.tobytes()
    elif isinstance(value, Enum):
        body = _class(kind) + value.name.encode()
    elif dataclasses.is_dataclass(kind):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        body = _class(kind) + mapping(fields)
    elif isinstance(value, Description):
        body = _class(kind) + mapping({name: getattr(value, name) for name in kind.model_fields})
        if isinstance(value, FilePacking):
            body += _packed(_table(value))
    elif isinstance(value, Mapping):
        body = _class(kind) + mapping(value)
    elif isinstance(value, (set, frozenset)):
        body = b"".join(sorted(_packed(_described(part, around)) for part in value))
    elif isinstance(value, (list, tuple)):
        body = _class(kind) + many(value)
    elif isinstance(value, functools.partial):
        body = many((value.func, value.args, value.keywords))
    elif isinstance(value, types.MethodType) or (inspect.isbuiltin(value) and not inspect.ismodule(value.__self__)):
        body = many((getattr(value, "__func__", value.__name__), value.__self__))
    elif isinstance(value, types.CodeType):
        handlers = getattr(value, "co_exceptiontable", b"")
        body = many((sys.version, value.co_code, handlers, value.co_consts, value.co_names, value.co_varnames))
    elif isinstance(value, (types.ModuleType, np.ufunc)):
        body = value.__name__.encode()
    elif isinstance(value, type):
        body = _class(value)
    elif inspect.isroutine(value) or hasattr(value, "__wrapped__") or hasattr(value, "py_func"):
        body = _function(value, around)
    elif isinstance(value, os.PathLike):
        body = os.fsencode(value)
    else:
        raise Indistinct(f"a value of type {kind.__qualname__} cannot be told from others by its content")
    return f"{kind.__module__}.{kind.__qualname__}:".encode() + body


def _packed(body: bytes) -> bytes:
    return hashlib.sha256(body).digest()


def _table(packing: FilePacking) -> bytes:
    try:
        return packing.file.read_bytes()
    except OSError as error:
        raise Indistinct(f"{packing.file} cannot be read: {error.strerror}") from None


def _class(kind: type) -> bytes:
    """A class by its name and the file it stands in."""
    if (named := _importable(kind)) is None:
        raise Indistinct(f"class {kind.__qualname__} stands in no module that can be imported")
    return named


def _function(function: Any, within: tuple[int, ...]) -> bytes:
    """A function by its name and file if it can be imported, else by its code and what this refers to.

    One of the running script counts by both: what it refers to may be another value in each run.
    """
    named = _importable(function)
    if named is not None and not (function.__module__ == "__main__" and isinstance(function, types.FunctionType)):
        return named
    if not isinstance(function, types.FunctionType):
        raise Indistinct(f"{function!r} cannot be told from other functions by its content")
    cells = []
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            cells.append((name, cell.cell_contents))
        except ValueError:  # not filled yet
            cells.append((name, None))
    used = sorted({name for code in _codes(function.__code__) for name in code.co_names} & function.__globals__.keys())
    parts = (
        function.__code__,
        function.__defaults__,
        function.__kwdefaults__,
        cells,
        [(name, function.__globals__[name]) for name in used],
    )
    return (named or b"") + b"".join(_packed(_described(part, within)) for part in parts)


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    """A code object and those of the functions that stand in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes(constant)


def _importable(value: Any) -> bytes | None:
    """Module, name and file of a function or class that its module has under its name; None of others.

    A file of this package or of Python's own is not read: see :func:`sources`.
    """
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    if isinstance(value, type) and value.__module__ == "builtins":
        return value.__qualname__.encode()
    found: Any = module
    for part in value.__qualname__.split("."):
        found = vars(found).get(part) if hasattr(found, "__dict__") else None
    if isinstance(found, (staticmethod, classmethod)):
        found = found.__func__
    if module is None or found is not value:
        return None
    name = f"{module.__name__}.{value.__qualname__}:".encode()
    package = module.__name__.partition(".")[0]
    if package == __name__.partition(".")[0] or package in sys.stdlib_module_names - {"__main__"}:
        return name
    file = getattr(module, "__file__", None)
    if file is None:
        return None if package == "__main__" else name  # a notebook's; of a compiled module
    try:
        return name + _packed(Path(file).read_bytes())
    except OSError:
        return None
