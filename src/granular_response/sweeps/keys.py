"""Keys made from content: equal values have equal keys in every process, others have others.

A key is the digest of a value written as canonical JSON: a scene by its keys, its table and its law from outside, a
dataclass by its fields, an array by its bytes, a function or class by its name and the file it stands in. What stands
under its name in no file (a lambda, a function of a notebook) has no key: nothing is kept under it, and nothing of
another value is found.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import operator
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import Enum
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import GranularError
from ..inputs import read_bytes
from ..scene.base import Description
from ..scene.material import KNOWN_LAWS, Contact
from ..scene.table import FilePacking

_PACKAGE = Path(__file__).parents[1]


class Indistinct(GranularError, ValueError):
    """A value that cannot be told from others by its content. One line that names it."""


def key(*values: Any, packages: Collection[str] = ()) -> str:
    """32 hexadecimal digits for values, the same in every process: equal values, equal keys.

    What stands in ``packages`` goes by its name alone, as what stands in this one: :func:`sources` has its code. Raises
    Indistinct for values of another kind than those above, and a table that cannot be read.
    """
    by_name = {__name__.partition(".")[0], "numpy", *packages, *sys.stdlib_module_names} - {"__main__"}
    return _sha256(json.dumps(_plain(values, by_name)).encode())[:32]


@functools.cache
def sources(*parts: str) -> str:
    """Key of the present code of some parts of this package, of all if none is named, and of what computes in it.

    A part is a folder or a file of this package, or another package by its name, with a folder or a file in it after
    that or not: ``linalg``, ``state/box.py``, ``other``, ``other/tasks.py``.
    """
    files = sorted({file for part in parts or ("",) for file in _files(part)})
    # datasets are kept as xarray pickles them
    versions = [metadata.version(package) for package in ("numba", "numpy", "scipy", "xarray")]
    return key([(name, read_bytes(path)) for name, path in files], versions)


def _files(part: str) -> Iterator[tuple[str, Path]]:
    """Name and path of each file of a part."""
    place, base = _PACKAGE / part, _PACKAGE
    if not place.exists():
        package, _, inside = part.partition("/")
        spec = find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            raise ModuleNotFoundError(f"{part}: no part of this package, and no package {package}", name=package)
        folder = Path(spec.submodule_search_locations[0])
        place, base = folder / inside, folder.parent
    for path in place.rglob("*.py") if place.is_dir() else [place]:
        yield path.relative_to(base).as_posix(), path


def _plain(value: Any, by_name: Collection[str]) -> Any:
    """A value as JSON has it: numbers, truth values and text as they are, others as a list with their class first."""
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, type) or (callable(value) and hasattr(value, "__qualname__")):
        return ["named", *_named(value, by_name)]
    return [*_named(type(value), by_name), *_parts(value, by_name)]


def _parts(value: Any, by_name: Collection[str]) -> list[Any]:
    """What tells a value from others of its class."""

    def plain(values: Iterable[Any]) -> list[Any]:
        return [_plain(one, by_name) for one in values]

    if isinstance(value, (bytes, bytearray)):
        return [_sha256(value)]
    if isinstance(value, (np.ndarray, np.generic)) and not value.dtype.hasobject:
        return [repr(value.dtype.descr), value.shape, _sha256(value.tobytes())]
    if isinstance(value, (Path, range)):
        return [str(value)]
    if isinstance(value, Enum):
        return [value.name]
    if isinstance(value, (list, tuple)):
        return plain(value)
    if isinstance(value, (Mapping, set, frozenset)):
        return sorted(plain(value.items() if isinstance(value, Mapping) else value), key=json.dumps)
    if isinstance(value, functools.partial):
        return plain((value.func, value.args, value.keywords))
    if isinstance(value, Description):
        table = [_table(value)] if isinstance(value, FilePacking) else []
        outside = KNOWN_LAWS[value.law].law if isinstance(value, Contact) else None
        law = [outside] if outside else []
        return [*plain(getattr(value, name) for name in type(value).model_fields), *table, *plain(law)]
    if dataclasses.is_dataclass(value):
        return plain(getattr(value, field.name) for field in dataclasses.fields(value))
    raise Indistinct(f"a value of class {type(value).__qualname__} cannot be told from others by its content")


def _named(value: Any, by_name: Collection[str]) -> list[Any]:
    """Module and name of a function or class, and the file where it is not one of the packages ``by_name``."""
    kind = "class" if isinstance(value, type) else "function"
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    try:
        known = operator.attrgetter(value.__qualname__)(module) is value
    except AttributeError:
        known = False
    file = getattr(module, "__file__", None)
    if not known or (value.__module__ == "__main__" and (file is None or not Path(file).is_file())):
        raise Indistinct(f"{kind} {value.__qualname__} stands in no module that can be imported")
    name = [value.__module__, value.__qualname__]
    if value.__module__.partition(".")[0] in by_name or not (file and file.endswith(".py")):
        return name
    return [*name, _sha256(read_bytes(file))]


def _table(packing: FilePacking) -> str:
    try:
        return _sha256(read_bytes(packing.file))
    except OSError as error:
        raise Indistinct(f"{packing.file} cannot be read: {error.strerror}") from None


def _sha256(data: bytes | bytearray) -> str:
    return hashlib.sha256(data).hexdigest()
