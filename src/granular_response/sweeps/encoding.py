"""Values as bytes that hold no code, and back: what is kept on disk between runs.

The bytes are those of a ``.npz`` archive without objects: the arrays, and ``tree``, the rest as JSON. Nothing that a
file says is called: classes are dataclasses, named tuples, enumerations and descriptions of this package, or of a
module that the reader names and has loaded, and get exactly the fields that they have.
"""

from __future__ import annotations

import dataclasses
import importlib
import io
import json
import re
import sys
import zipfile
import zlib
from collections.abc import Collection, Mapping
from enum import Enum
from typing import Any

import numpy as np

from ..scene.base import Description
from ..scene.scene import Scene
from ..store.labelled import Labelled, Values, labelled

_PACKAGE = __name__.partition(".")[0]
#: Modules of this package that hold values; the others are programs.
_OWN = re.compile(rf"{_PACKAGE}(\.(?!cli\b|__)[a-z_0-9]+)+")


class NotEncodable(TypeError):
    """A value of a kind that is not kept. One line that names it."""


class NotDecodable(ValueError):
    """Bytes that ``encode`` did not make, or made from classes that are no longer there."""


def encode(value: Any, modules: Collection[str] = ()) -> bytes:
    """Bytes from which ``decode`` makes an equal value, arrays and numbers to the last bit.

    Parameters
    ----------
    value
        Numbers, text, arrays without objects, xarray datasets, lists, tuples, sets and mappings of such, and
        dataclasses, named tuples, enumerations and scenes.
    modules
        Whose classes may occur, beside those of this package.

    Raises
    ------
    NotEncodable
        For anything else.
    """
    writer = _Writer(modules)
    try:
        tree = json.dumps(writer.tree(value))
    except RecursionError:
        raise NotEncodable("a value that holds itself is not kept") from None
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, tree=np.frombuffer(tree.encode(), np.uint8), **writer.arrays)
    return stream.getvalue()


def decode(data: bytes, modules: Collection[str] = ()) -> Any:
    """The value that was encoded; see :func:`encode`.

    Raises
    ------
    NotDecodable
        If these are no bytes of ``encode``, or the classes in them are not there, not allowed or have other fields.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            tree = json.loads(archive["tree"].tobytes())
            return _Reader(archive, modules).value(tree)
    except NotDecodable:
        raise
    except (ArithmeticError, AttributeError, ImportError, LookupError, OSError, RecursionError, TypeError, ValueError,
            MemoryError, EOFError, NotImplementedError, zipfile.BadZipFile, zlib.error) as error:  # fmt: skip
        raise NotDecodable(f"cannot be read: {type(error).__name__}") from None


class _Writer:
    """Collects the arrays of a value."""

    def __init__(self, modules: Collection[str]) -> None:
        self.modules = modules
        self.arrays: dict[str, np.ndarray] = {}

    def tree(self, value: Any) -> Any:
        """The value as JSON: plain numbers and text as they are, all else as ``{kind: content}``."""
        kind = type(value)
        if value is None or kind in (bool, int, float, str):
            return value
        if kind is np.ndarray or isinstance(value, np.generic):
            return {"array" if kind is np.ndarray else "scalar": self._array(np.asanyarray(value))}
        if kind in (list, tuple, set, frozenset):
            return {kind.__name__: [self.tree(part) for part in value]}
        if kind is bytes:
            return {"bytes": value.hex()}
        if isinstance(value, Enum):
            return {"enumeration": self._class(kind), "name": value.name}
        if isinstance(value, Scene):
            return {"scene": value.to_dict(), "folder": value.folder}
        if isinstance(value, Description):
            return {"description": self._class(kind), "values": value.model_dump(mode="json")}
        if dataclasses.is_dataclass(kind):
            fields = {field.name: self.tree(getattr(value, field.name)) for field in dataclasses.fields(value)}
            return {"dataclass": self._class(kind), "fields": fields}
        if isinstance(value, tuple) and hasattr(kind, "_fields"):
            return {"named": self._class(kind), "parts": [self.tree(part) for part in value]}
        if isinstance(value, Mapping) and (kind is dict or kind.__module__ == "builtins"):
            return {"dict": [[self.tree(key), self.tree(part)] for key, part in value.items()]}
        if f"{kind.__module__}.{kind.__qualname__}" == "xarray.core.dataset.Dataset":
            return {"dataset": self._dataset(labelled(value))}
        raise NotEncodable(f"a value of type {kind.__module__}.{kind.__qualname__} is not kept")

    def _array(self, values: np.ndarray) -> str:
        if values.dtype.hasobject or values.dtype.kind not in "biufcSUV":
            raise NotEncodable(f"an array of type {values.dtype} is not kept")
        name = f"a{len(self.arrays)}"
        self.arrays[name] = values
        return name

    def _class(self, kind: type) -> str:
        if not _allowed(kind.__module__, self.modules) or _class_of(kind.__module__, kind.__qualname__) is not kind:
            raise NotEncodable(f"a value of class {kind.__module__}.{kind.__qualname__} is not kept")
        return f"{kind.__module__}:{kind.__qualname__}"

    def _dataset(self, data: Labelled) -> Any:
        variables = [
            [name, list(dimensions), self.tree(np.asarray(values)), self.tree(attributes)]
            for name, (dimensions, values, attributes) in data.variables.items()
        ]
        return [variables, sorted(data.coordinates), self.tree(dict(data.attributes))]


class _Reader:
    """Makes values of what a writer has collected."""

    def __init__(self, arrays: Mapping[str, np.ndarray], modules: Collection[str]) -> None:
        self.arrays = arrays
        self.modules = modules

    def value(self, tree: Any) -> Any:
        match tree:
            case None | bool() | int() | float() | str():
                return tree
            case {"array": str(name)}:
                return self.arrays[name]
            case {"scalar": str(name)}:
                return self.arrays[name][()]
            case {"list": parts}:
                return [self.value(part) for part in parts]
            case {"tuple": parts}:
                return tuple(self.value(part) for part in parts)
            case {"set": parts}:
                return {self.value(part) for part in parts}
            case {"frozenset": parts}:
                return frozenset(self.value(part) for part in parts)
            case {"dict": entries}:
                return {self.value(key): self.value(part) for key, part in entries}
            case {"bytes": str(digits)}:
                return bytes.fromhex(digits)
            case {"scene": dict(data), "folder": folder}:
                return Scene.from_dict(data, folder=folder)
            case {"description": str(name), "values": dict(values)}:
                return self._class(name, Description).model_validate(values)
            case {"enumeration": str(name), "name": str(member)}:
                return self._class(name, Enum)[member]
            case {"dataclass": str(name), "fields": dict(fields)}:
                return self._dataclass(self._class(name, object), fields)
            case {"named": str(name), "parts": list(parts)}:
                kind = self._class(name, tuple)
                if len(parts) != len(kind._fields):
                    raise NotDecodable(f"{name} has other fields")
                return tuple.__new__(kind, [self.value(part) for part in parts])
            case {"dataset": [variables, coordinates, attributes]}:
                made = {
                    name: Values(tuple(dimensions), self.value(values), self.value(labels))
                    for name, dimensions, values, labels in variables
                }
                return Labelled(made, frozenset(coordinates), self.value(attributes)).dataset()
        raise NotDecodable("holds something that was never written")

    def _dataclass(self, kind: type, fields: dict[str, Any]) -> Any:
        if not dataclasses.is_dataclass(kind) or [field.name for field in dataclasses.fields(kind)] != list(fields):
            raise NotDecodable(f"{kind.__qualname__} has other fields")
        made = object.__new__(kind)
        for name, tree in fields.items():
            object.__setattr__(made, name, self.value(tree))
        return made

    def _class(self, name: str, base: type) -> Any:
        """The class of a name, if it is one that may be made and is what it must be."""
        module, _, qualified = name.partition(":")
        kind = _class_of(module, qualified) if _allowed(module, self.modules) else None
        if kind is None or not issubclass(kind, base):
            raise NotDecodable(f"{name} is no class that may be made")
        return kind


def _allowed(module: str, modules: Collection[str]) -> bool:
    return module in modules or _OWN.fullmatch(module) is not None


def _class_of(module: str, qualified: str) -> type | None:
    """A class of a loaded module, or of one of this package."""
    if _OWN.fullmatch(module) is not None:
        importlib.import_module(module)
    found: Any = sys.modules.get(module)
    for part in qualified.split("."):
        found = vars(found).get(part) if hasattr(found, "__dict__") else None
    return found if isinstance(found, type) and found.__module__ == module else None
