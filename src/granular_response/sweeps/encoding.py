"""Values as bytes that hold no code, and back: what is kept on disk between runs.

The bytes are a pickle of which only such parts are read as make values: arrays and numbers of numpy, and dataclasses,
named tuples, enumerations and descriptions of this package, or of a module that the reader names and has loaded.
"""

from __future__ import annotations

import dataclasses
import io
import pickle
import sys
from collections.abc import Collection, Mapping
from enum import Enum
from typing import Any

import xarray as xr

from ..errors import GranularError
from ..scene.base import Description

#: What pickles of arrays, numbers, sets, paths and datasets call.
_PLAIN = {
    __name__: {"_dataset"},
    "builtins": {"bytearray", "complex", "frozenset", "range", "set"},
    "numpy": {"dtype", "ndarray"},
    "numpy._core.multiarray": {"_reconstruct", "scalar"},
    "numpy._core.numeric": {"_frombuffer"},
    "pathlib": {"PosixPath"},
}


class NotEncodable(GranularError, TypeError):
    """A value of a kind that is not kept. One line that names it."""


class NotDecodable(GranularError, ValueError):
    """Bytes that ``encode`` did not make, or made from classes that are no longer there."""


def encode(value: Any, modules: Collection[str] = ()) -> bytes:
    """Bytes from which ``decode`` makes an equal value, arrays and numbers to the last bit.

    A value is numbers, text, arrays, xarray datasets, lists, tuples, sets and mappings of such, and dataclasses, named
    tuples, enumerations and scenes. Classes of ``modules`` may occur, beside those of this package; a package stands
    for all of its modules. Raises NotEncodable for anything else.
    """
    stream = io.BytesIO()
    try:
        _Writer(stream, protocol=5).dump(value)
        decode(stream.getvalue(), modules)
    except Exception as error:  # whatever the methods of a value raise
        raise NotEncodable(" ".join(f"a value is not kept: {error}".split())) from None
    return stream.getvalue()


def decode(data: bytes, modules: Collection[str] = ()) -> Any:
    """The value that was encoded; see :func:`encode`.

    Raises NotDecodable if these are no bytes of ``encode``, or the classes in them are not there or not allowed.
    """
    try:
        return _Reader(io.BytesIO(data), modules).load()
    except NotDecodable:
        raise
    except Exception as error:  # a damaged pickle can raise anything
        raise NotDecodable(f"cannot be read: {type(error).__name__}") from None


class _Writer(pickle.Pickler):
    def reducer_override(self, value: Any) -> Any:
        """A dataset goes by its parts: the classes inside are xarray's own affair."""
        if type(value) is not xr.Dataset:
            return NotImplemented
        variables = {name: (one.dims, one.values, one.attrs) for name, one in value.variables.items()}
        return _dataset, (variables, list(value.coords), value.attrs)


def _dataset(variables: Mapping[str, Any], coordinates: Collection[str], attributes: Mapping[str, Any]) -> xr.Dataset:
    return xr.Dataset(variables, attrs=attributes).set_coords(coordinates)


class _Reader(pickle.Unpickler):
    """Finds nothing but what makes values."""

    def __init__(self, stream: io.BytesIO, modules: Collection[str]) -> None:
        super().__init__(stream)
        self.modules = modules

    def find_class(self, module: str, name: str) -> Any:
        if name in _PLAIN.get(module, ()):
            return super().find_class(module, name)
        own = module.partition(".")[0] == __name__.partition(".")[0]
        named = module in sys.modules and any(f"{module}.".startswith(f"{given}.") for given in self.modules)
        if own or named:
            kind = super().find_class(module, name)
            if isinstance(kind, type) and kind.__module__ == module and _holds_values(kind):
                return kind
        raise NotDecodable(f"{module}.{name} is no class that may be made")


def _holds_values(kind: type) -> bool:
    return (
        dataclasses.is_dataclass(kind)
        or issubclass(kind, (Enum, Description))
        or (issubclass(kind, tuple) and hasattr(kind, "_fields"))
    )
