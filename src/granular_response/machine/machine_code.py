"""How kernels are compiled, how a type chooses what they call, and where their machine code is kept.

Numba keeps machine code by the file of a kernel, but a kernel also holds code inlined from other files. So the folder
is named after all sources that kernels are made of: what was compiled from others is never found again. Nothing is
ever deleted here.
"""

from __future__ import annotations

import fcntl
import hashlib
import inspect
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from functools import cache, partial, wraps
from pathlib import Path
from typing import Any

import numba as nb
from numba.extending import overload

_PACKAGE = Path(__file__).parents[1]
#: Folders of the package whose files make kernels or are inlined into them.
SOURCES = ("contact", "kernels", "machine", "linalg", "state")


def kernel(function: Callable | None = None, **options: Any) -> Any:
    """Decorator: compile with Numba on first use and keep the machine code.

    Kernels have no Python errors of division, make no arrays and so count no references to them: counting costs a
    small scene half of its time. ``options`` are those of ``numba.njit`` beside that. Raises ValueError for
    ``fastmath``: the compiler then sums in the order of a processor's registers, and others give other digits.
    """
    if options.get("fastmath"):
        raise ValueError("fastmath is not allowed: results would depend on the processor; write out the order of sums")
    if function is None:
        return partial(kernel, **options)
    folder = cache_folder()
    before = nb.config.CACHE_DIR
    if folder is not None:
        nb.config.CACHE_DIR = str(folder)  # asked for when a function is decorated, so others keep their own
    try:
        compiled = nb.njit(cache=folder is not None, error_model="numpy", _nrt=False, **options)(function)
    finally:
        nb.config.CACHE_DIR = before
    if folder is not None and hasattr(compiled, "_cache"):  # not with compilation off
        _keep_own_types_alone(compiled, folder / "lock")
    return compiled


def by_type(function: Callable) -> Any:
    """Decorator: the method of the same name of the first argument, in Python and in compiled code alike.

    The argument is a named tuple (a contact law, an integrator), of a class in a module that can be imported. Compiled
    code knows the class from the type, so the choice costs nothing at run time. The arguments and the docstring of
    ``function`` say what the methods have in common; its body is run for classes that have no such method.
    """
    name = function.__name__

    @wraps(function)
    def called(self, *arguments):
        return getattr(type(self), name, function)(self, *arguments)

    def method(*types):
        return getattr(types[0].instance_class, name, function)

    # Numba compares the names of the arguments
    method.__signature__ = called.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    overload(called, jit_options={"error_model": "numpy", "forceinline": True})(method)
    return called


def _keep_own_types_alone(compiled: Any, lock: Path) -> None:
    """Code for a law or an integrator from elsewhere is not kept: a process that lacks it could not read the index.

    Numba reads the index of a kernel, picks the next free file and writes both. Two processes at once, with code for
    different arguments, would pick the same file, and the index then names the code of one for the arguments of the
    other. So one process writes at a time.
    """
    save = compiled._cache.save_overload

    def save_own(arguments: Any, data: Any) -> None:
        if not all(map(_is_own, arguments)):
            return
        with ExitStack() as held:
            with suppress(OSError):  # a file system without locks
                # a pipe in its place would wait to be opened
                descriptor = os.open(lock, os.O_WRONLY | os.O_CREAT | os.O_NONBLOCK, 0o666)
                held.callback(os.close, descriptor)
                fcntl.lockf(descriptor, fcntl.LOCK_EX)
            save(arguments, data)

    compiled._cache.save_overload = save_own


def _is_own(kind: Any) -> bool:
    """Whether a type, with its parts, is Numba's or of a class of this package."""
    made_by = getattr(kind, "instance_class", None)
    if made_by is not None and made_by.__module__.partition(".")[0] != __name__.partition(".")[0]:
        return False
    return all(map(_is_own, getattr(kind, "types", ())))


@cache
def cache_folder() -> Path | None:
    """The folder for machine code of these sources; None where nothing may be written.

    In ``NUMBA_CACHE_DIR`` if that is set, else in the package's ``__pycache__``, else in the user's cache.
    """
    name = source_digest()
    for base in _bases():
        folder = base / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    return None


def _bases() -> Iterator[Path]:
    if nb.config.CACHE_DIR:
        yield Path(nb.config.CACHE_DIR)
    yield _PACKAGE / "__pycache__" / "machine_code"
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(home):
        yield Path(home) / "granular_response"


def source_digest() -> str:
    """Name of the present state of the sources."""
    digest = hashlib.sha256()
    for part in SOURCES:
        for path in sorted((_PACKAGE / part).rglob("*.py")):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
