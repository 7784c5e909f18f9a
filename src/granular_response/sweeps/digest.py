"""Names made from content: equal values have equal names in every process, others have others.

A name is the digest of what pickle makes of a value, so of all that a worker process would get of it. Some values stand
there by what they are: a scene by its keys and its table, a dataclass by its fields, a function or class of a module by
its name and the file it stands in. Functions of the running script, of a notebook or of another function have all that
they refer to in their pickle (cloudpickle).

What cannot be pickled has no name, so that nothing is kept under it and nothing of another value is found.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import io
import operator
import sys
import types
from collections.abc import Collection, Iterator, Mapping
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cloudpickle

from ..errors import GranularError
from ..inputs import check_regular
from ..scene.base import Description
from ..scene.table import FilePacking

_PACKAGE = Path(__file__).parents[1]


class Indistinct(GranularError, ValueError):
    """A value that cannot be told from others by its content. One line that names it."""


def digest(*values: Any, packages: Collection[str] = ()) -> str:
    """32 hexadecimal digits for values, the same in every process: equal values, equal names.

    What stands in ``packages`` goes by its name alone, as what stands in this one: :func:`sources` has its code.

    Raises
    ------
    Indistinct
        For values that cannot be pickled, classes that cannot be imported, and a table that cannot be read.
    """
    try:
        return _pickled(values, _Met(packages)).hex()[:32]
    except Indistinct:
        raise
    except Exception as error:  # whatever the methods of a value raise
        raise Indistinct(f"a value cannot be told from others by its content: {' '.join(str(error).split())}") from None


@functools.cache
def sources(*parts: str) -> str:
    """Name of the present code of some parts of this package, of all if none is named, and of what computes in it.

    A part is a folder or a file of this package, or another package by its name, with a folder or a file in it after
    that or not: ``solve/linear``, ``state/box.py``, ``other``, ``other/tasks.py``.
    """
    files = sorted({file for part in parts or ("",) for file in _files(part)})
    versions = [metadata.version(package) for package in ("numba", "numpy", "scipy")]
    return digest({name: path.read_bytes() for name, path in files}, versions)


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


class _Met:
    """What parts of one name share: functions that were met, by their order, and packages that go by name."""

    def __init__(self, packages: Collection[str]) -> None:
        self.functions: dict[int, int] = {}
        self.by_name = {__name__.partition(".")[0], *packages, *sys.stdlib_module_names} - {"__main__"}


def _pickled(value: Any, met: _Met) -> bytes:
    stream = io.BytesIO()
    _Pickler(stream, met).dump(value)
    return hashlib.sha256(stream.getvalue()).digest()


class _Pickler(cloudpickle.Pickler):
    """Makes the same bytes of equal values."""

    def __init__(self, stream: io.BytesIO, met: _Met) -> None:
        super().__init__(stream, protocol=5)
        self.fast = True  # two equal parts count as that, be they one object or not
        self.met = met

    def persistent_id(self, value: Any) -> Any:
        """What stands for a value; None where it is pickled."""
        kind = type(value)
        if isinstance(value, Description):
            fields = {name: getattr(value, name) for name in kind.model_fields}
            return kind, fields, _table(value) if isinstance(value, FilePacking) else None
        if dataclasses.is_dataclass(kind):
            return kind, [getattr(value, field.name) for field in dataclasses.fields(kind)]
        if isinstance(value, (Mapping, set, frozenset)):
            parts = value.items() if isinstance(value, Mapping) else value
            return kind, sorted(_pickled(part, self.met) for part in parts)
        if kind is types.CodeType:  # wherever it stands
            arguments = value.co_argcount, value.co_posonlyargcount, value.co_kwonlyargcount, value.co_flags
            names = value.co_names, value.co_varnames
            return sys.version, value.co_code, value.co_exceptiontable, value.co_consts, names, arguments
        return self._named(value) if callable(value) else None

    def _named(self, value: Any) -> Any:
        """A function or class by its name, and a function that was met before by its place among those."""
        is_class = isinstance(value, type)
        # what a function of the running script refers to may be another value in each run
        by_name = is_class or getattr(value, "__module__", None) != "__main__"
        if by_name and (named := _importable(value, self.met.by_name)) is not None:
            return named
        if is_class and value.__module__ != "builtins":
            raise Indistinct(f"class {value.__qualname__} stands in no module that can be imported")
        if hasattr(value, "py_func"):  # compiled
            return "compiled", value.py_func
        if isinstance(value, types.FunctionType):
            functions = self.met.functions
            if id(value) in functions:
                return "met", functions[id(value)]
            functions[id(value)] = len(functions)
        return None


def _table(packing: FilePacking) -> bytes:
    try:
        check_regular(packing.file)
        return packing.file.read_bytes()
    except OSError as error:
        raise Indistinct(f"{packing.file} cannot be read: {error.strerror}") from None


def _importable(value: Any, by_name: Collection[str]) -> tuple[Any, ...] | None:
    """Module, name and file of a function or class that its module has under its name; None of others.

    A file of the packages ``by_name`` is not read.
    """
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    try:
        if operator.attrgetter(value.__qualname__)(module) is not value:
            return None
    except AttributeError:
        return None
    assert module is not None
    name, package = (module.__name__, value.__qualname__), module.__name__.partition(".")[0]
    if package in by_name:
        return name
    file = getattr(module, "__file__", None)
    if file is None and package == "__main__":  # a notebook's
        return None
    return (*name, Path(file).read_bytes() if file and file.endswith(".py") else None)
