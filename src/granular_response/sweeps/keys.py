"""Keys made from content: equal values have equal keys in every process, others have others.

A key is the digest of a value written as canonical JSON: a scene by its keys, the files that it names and its law from
outside, also where mappings or the name of its file describe it, a dataclass by its fields, an array by its bytes, a
``Path`` by its name and what the file holds, and what a class of the user's own derives from these by its further
attributes. A function or class goes by its name, the module it stands in with the packages around it, and every module
of the user's own that this one imports, directly or not: at its top, inside a function, by a relative import, by any
call with its name as a text, or from a place of its own. The user's own are those outside the standard library and the
folders of installed packages. What stands under its name in no file (a lambda, a function of a notebook) has no key:
nothing is kept under it, and nothing of another value is found.
"""

from __future__ import annotations

import ast
import dataclasses
import functools
import hashlib
import itertools
import json
import operator
import os
import sys
import sysconfig
from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import Enum
from importlib import metadata
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec, resolve_name
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ..errors import GranularError
from ..inputs import read_bytes
from ..scene import Scene
from ..scene.base import Description, PackingDescription
from ..scene.material import KNOWN_LAWS, Contact

_PACKAGE = Path(__file__).parents[1]

#: What the name of a scene file may end with.
_SCENE_FILES = (".yaml", ".yml")

#: Folders of what is installed.
_INSTALLED = tuple({sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")})


class Indistinct(GranularError, ValueError):
    """A value that cannot be told from others by its content. One line that names it."""


def key(*values: Any, packages: Collection[str] = (), code: dict[str, str] | None = None) -> str:
    """32 hexadecimal digits for values, the same in every process: equal values, equal keys.

    What stands in ``packages`` goes by its name alone, as what stands in this one: :func:`sources` has its code.
    ``code`` holds the digests of modules that were read for other keys, which are then not read again. Raises
    Indistinct for values of another kind than those above, and a file that cannot be read.
    """
    by_name = {__name__.partition(".")[0], "numpy", *packages}
    return _sha256(json.dumps(_Content(by_name, {} if code is None else code).plain(values)).encode())[:32]


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


class _Content:
    """Values as JSON has them; packages ``by_name``, and digests of modules in ``code``."""

    def __init__(self, by_name: Collection[str], code: dict[str, str]) -> None:
        self.by_name, self.code = by_name, code

    def plain(self, value: Any) -> Any:
        """Numbers, truth values and text as they are, others as a list with their class first."""
        if value is None or type(value) in (bool, int, float, str):
            scene = isinstance(value, str) and value.endswith(_SCENE_FILES) and os.path.isfile(value)
            return ["file", *self.plain(Path(value))] if scene else value
        if isinstance(value, type) or (callable(value) and hasattr(value, "__qualname__")):
            return ["named", *self.named(value)]
        return [*self.named(type(value)), *self.parts(value), *self.beside(value)]

    def parts(self, value: Any) -> list[Any]:
        """What tells a value from others of its class."""

        def plain(values: Iterable[Any]) -> list[Any]:
            return list(map(self.plain, values))

        if isinstance(value, (bytes, bytearray)):
            return [_sha256(value)]
        array = isinstance(value, (np.ndarray, np.generic)) and not isinstance(value, np.ma.MaskedArray)
        if array and not value.dtype.hasobject:
            return [repr(value.dtype.descr), value.shape, _sha256(value.tobytes())]
        if isinstance(value, Path):
            scene = self.described(value) if value.name.endswith(_SCENE_FILES) else []
            return [str(value), *([_sha256(_read(value)), *scene] if value.is_file() else [])]
        if isinstance(value, range):
            return [str(value)]
        if isinstance(value, Enum):
            return [value.name or value.value]  # bits of a Flag that have no name
        if isinstance(value, (list, tuple)):
            return plain(value)
        if isinstance(value, (Mapping, set, frozenset)):
            scene = self.described(value) if isinstance(value, Mapping) and "packing" in value else []
            return [*sorted(plain(value.items() if isinstance(value, Mapping) else value), key=json.dumps), *scene]
        if isinstance(value, functools.partial):
            return plain((value.func, value.args, value.keywords))
        if isinstance(value, Description):
            files = getattr(value, "files", ()) if isinstance(value, PackingDescription) else ()
            outside = KNOWN_LAWS[value.law].law if isinstance(value, Contact) else None
            law = [outside] if outside else []
            fields = plain(getattr(value, name) for name in type(value).model_fields)
            return [*fields, *(_sha256(_read(file)) for file in files), *plain(law)]
        if dataclasses.is_dataclass(value):
            return plain(getattr(value, field.name) for field in dataclasses.fields(value))
        raise Indistinct(f"a value of class {type(value).__qualname__} cannot be told from others by its content")

    def described(self, value: Path | Mapping[str, Any]) -> list[Any]:
        """The scene that a file or mappings describe, if they do."""
        try:
            scene = Scene.from_dict(value) if isinstance(value, Mapping) else Scene.from_yaml(value)
        except GranularError:
            return []
        return [self.plain(scene)]

    def beside(self, value: Any) -> list[Any]:
        """Attributes that a class of the user's own has beside what it is derived from; values it has cached do not
        count."""
        kind = type(value)
        if kind.__module__.partition(".")[0] in self.by_name or isinstance(value, (Description, Enum, Path)):
            return []
        state = object.__getstate__(value)  # of __dict__, and of __slots__ where there are any
        more = {
            name: one
            for part in (state if isinstance(state, tuple) else (state,))
            for name, one in (part or {}).items()
            if not isinstance(getattr(kind, name, None), functools.cached_property)
        }
        return [self.plain(more)] if more else []

    def named(self, value: Any) -> list[Any]:
        """Module and name of a function or class, and its code where it is not one of the packages ``by_name``."""
        kind = "class" if isinstance(value, type) else "function"
        module = sys.modules.get(getattr(value, "__module__", None) or "")
        try:
            known = operator.attrgetter(value.__qualname__)(module) is value
        except AttributeError:
            known = False
        file: str = getattr(module, "__file__", None) or ""
        main = value.__module__ in ("__main__", "__mp_main__")  # the second: in a worker
        if not known or module is None or (main and not Path(file).is_file()):
            raise Indistinct(f"{kind} {value.__qualname__} stands in no module that can be imported")
        name = ["__main__" if main else value.__module__, value.__qualname__]
        top, own = value.__module__.partition(".")[0], _own(Path(file))
        package = file.endswith(".py") and top not in sys.stdlib_module_names  # installed: this module alone
        if top in self.by_name or not (own or package):
            return name
        if value.__module__ not in self.code:
            self.code[value.__module__] = self._code(module, Path(file))
        return [*name, self.code[value.__module__]]

    def _code(self, module: ModuleType, file: Path) -> str:
        """Digest of a module and of all of the user's own that it imports."""
        waiting: list[tuple[str, str, Path, ModuleType | None]] = [
            (module.__name__, module.__package__ or "", file, module)
        ]
        found, looked = dict[tuple[str, Path], str](), set[str]()
        while waiting:
            name, package, path, loaded = waiting.pop()
            if (name, path) in found or name.partition(".")[0] in self.by_name:
                continue
            data = _read(path)
            found[name, path] = _sha256(data)
            imported = _imports(data, package) if path.suffix == ".py" else frozenset()
            for name in {above for one in (package, *imported) for above in _ancestors(one)} - looked:
                looked.add(name)
                spec = _spec(name)
                if spec and spec.origin and _own(origin := Path(spec.origin)):
                    waiting.append((name, spec.parent or "", origin, sys.modules.get(name)))
            for one in list(vars(loaded).values()) if loaded else ():  # also from a place where no import looks
                origin = Path((isinstance(one, ModuleType) and getattr(one, "__file__", None)) or "")
                if _own(origin):
                    waiting.append((one.__name__, one.__package__ or "", origin, one))
        return _sha256(json.dumps(sorted((name, code) for (name, _), code in found.items())).encode())


@functools.lru_cache(maxsize=1000)
def _imports(code: bytes, package: str) -> frozenset[str]:
    """Names of all modules, and of what may be one, that a source imports anywhere."""
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError):  # a script in another language
        return frozenset()
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            found |= {base, *(f"{base}{'' if base.endswith('.') else '.'}{one.name}" for one in node.names)}
        elif isinstance(node, ast.Call):  # import_module, under whatever name
            given = (getattr(one, "value", None) for one in (*node.args, *(word.value for word in node.keywords)))
            found |= {one for one in given if isinstance(one, str) and one.replace(".", "").isidentifier()}
    return frozenset(filter(None, (_absolute(name, package) for name in found)))


def _ancestors(name: str) -> Iterator[str]:
    """A module and the packages around it."""
    return itertools.accumulate(name.split("."), "{}.{}".format) if name else iter(())


def _absolute(name: str, package: str) -> str:
    try:
        return resolve_name(name, package).removesuffix(".*").rstrip(".")
    except ImportError:  # beyond the top of the package
        return ""


def _spec(name: str) -> ModuleSpec | None:
    """Where a module is, without importing it or its package, which may have effects."""
    if name in sys.modules:
        return getattr(sys.modules[name], "__spec__", None)
    above = name.rpartition(".")[0]
    try:
        if not above:
            return find_spec(name)
        places = getattr(_spec(above), "submodule_search_locations", None)
        return PathFinder.find_spec(name, list(places)) if places else None
    except (ImportError, ValueError):
        return None


def _own(file: Path) -> bool:
    """Whether a module is the user's own: also one of an archive, which cannot be read."""
    installed = {"site-packages", "dist-packages"} & set(file.parts) or str(file).startswith(_INSTALLED)
    return bool(file.suffix) and not installed


def _read(file: Path) -> bytes:
    try:
        return read_bytes(file)
    except OSError as error:
        raise Indistinct(f"{file} cannot be read: {error.strerror}") from None


def _sha256(data: bytes | bytearray) -> str:
    return hashlib.sha256(data).hexdigest()
