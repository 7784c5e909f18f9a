"""How kernels are compiled, how a type chooses what they call, and where their machine code is kept.

Numba keeps machine code by the file of a kernel, but a kernel also holds code inlined from other files. So the folder
is named after all sources that kernels are made of: what was compiled from others is never found again. Nothing is
ever deleted here.

Kept code decides nothing. Each file has a digest of what it holds, since LLVM ends the process on damaged code. What
cannot be read is compiled again, and what cannot be written is not kept.
"""

from __future__ import annotations

import fcntl
import hashlib
import inspect
import logging
import os
import pickle
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, partial, wraps
from itertools import count
from pathlib import Path
from typing import Any

import numba as nb
import numpy as np
from numba.core import caching, compiler_lock
from numba.extending import overload

from ..inputs import read_bytes

_log = logging.getLogger(__name__)
_PACKAGE = Path(__file__).parents[1]
#: Folders of the package whose files make kernels or are inlined into them.
SOURCES = ("contact", "kernels", "machine", "linalg", "state")

#: Seconds to wait for another process that compiles the same kernel; the slowest takes 10 s on a quiet core.
LONGEST_COMPILATION = 120.0


def kernel(function: Callable | None = None, **options: Any) -> Any:
    """Decorator: compile with Numba on first use and keep the machine code.

    Kernels have no Python errors of division, make no arrays and so count no references to them: counting costs a
    small scene half of its time. Nor are they for C to call, which would take a seventh longer to compile. ``options``
    are those of ``numba.njit`` beside that. Raises ValueError for ``fastmath``: the compiler then sums in the order of
    a processor's registers, and others give other digits.
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
        compiled = nb.njit(
            cache=folder is not None, error_model="numpy", _nrt=False, no_cfunc_wrapper=True, **options
        )(function)  # fmt: skip
    finally:
        nb.config.CACHE_DIR = before
    if folder is not None and hasattr(compiled, "_cache"):  # not with compilation off
        _keep(compiled, folder)
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


def kind(*values: Any) -> tuple:
    """The types of values as compiled code tells them apart, also of those in named tuples. Arrays are contiguous.

    Examples
    --------
    >>> kind(1.0, np.zeros(3)) == kind(2.0, np.ones(4)), kind(1.0, np.zeros(3)) == kind(1.0, None)
    (True, False)
    """
    return tuple(
        (type(one), *kind(*one)) if isinstance(one, tuple)
        else (one.dtype, one.ndim) if isinstance(one, np.ndarray)
        else type(one)
        for one in values
    )  # fmt: skip


@cache
def typed(compiled: Callable, of: Any) -> Callable:
    """A kernel for calls whose arguments have the same types each time; those of one :func:`kind` share its code.

    Numba looks at all types at every call, and at the name of each field of a named tuple: that takes 7 us for a kernel
    of statics that works for half of one. Here the first call alone is looked at. Afterwards numbers are converted, but
    an array of another type, or one that is not contiguous, is read as if it were as the first.
    """
    if not hasattr(compiled, "compile"):  # with compilation off
        return compiled
    code = None

    def called(*arguments: Any) -> Any:
        nonlocal code
        if code is None:
            code = compiled.compile(tuple(map(nb.typeof, arguments)))
        return code(*arguments)

    return called


#: Classes by the names that Numba knows them by.
_classes: dict[str, type] = {}


def tell_apart(of: type) -> None:
    """Number the name of a class of named tuples if another one has it.

    Numba knows such a class by its name and the types of its fields. So one that a notebook defines anew would run the
    machine code of the one before.
    """
    name = of.__name__
    for number in count(2):
        if _classes.setdefault(of.__name__, of) is of:
            return
        of.__name__ = f"{name}_{number}"


class _Files(caching.IndexDataCacheFile):
    """Numba's index and data files of one kernel, each behind the digest of its content; data with what it is for."""

    def save(self, key: Any, data: Any) -> None:
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        made_for, data = super().load(key) or (key, None)
        if made_for != key:  # the index is of another time
            raise ValueError("its content is for other arguments")
        return data

    def _load_index(self) -> dict:
        try:
            version, packed = pickle.loads(_checked(read_bytes(self._index_path)))
        except FileNotFoundError:
            return {}
        stamp, overloads = pickle.loads(packed) if version == self._version else (None, {})
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict) -> None:
        self._write(self._index_path, (self._version, self._dump((self._source_stamp, overloads))))

    def _load_data(self, name: str) -> Any:
        return pickle.loads(_checked(read_bytes(self._data_path(name))))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(content).digest() + content)


def _checked(content: bytes) -> bytes:
    digest, content = content[:32], content[32:]
    if hashlib.sha256(content).digest() != digest:
        raise ValueError("its content is not what was written")
    return content


def _keep(compiled: Any, folder: Path) -> None:
    """Keep the machine code of a kernel in a folder, and compile what is not there in one process at a time.

    Numba reads the index of a kernel, picks the next free file and writes both. Two processes at once, with code for
    different arguments, would pick the same file, and the index then names the code of one for the arguments of the
    other. Beside that both would compile the same.
    """
    kept = compiled._cache
    kept._cache_file = files = _Files(kept._cache_path, kept._impl.filename_base, kept._impl.locator.get_source_stamp())
    load, save, compile_now = kept.load_overload, kept.save_overload, compiled.compile
    lock = Path(kept._cache_path) / f"{kept._impl.filename_base}.lock"

    def load_whole(signature: Any, context: Any) -> Any:
        try:
            return load(signature, context)
        except Exception as problem:  # whatever a damaged or unreadable file leads to
            _say_once(folder, f"cannot be read ({type(problem).__name__}), so kernels are compiled again")
            with suppress(OSError):
                files.flush()
            return None

    def save_own(arguments: Any, data: Any) -> None:
        """Code for a law or an integrator from elsewhere is not kept: a process that lacks it could not read it."""
        if not all(map(_is_own, arguments)):
            return
        try:
            save(arguments, data)
        except Exception as problem:  # a full or closed folder, or a damaged index
            _say_once(folder, f"cannot be written ({type(problem).__name__}), so kernels are compiled in every process")
            with suppress(OSError):
                files.flush()

    def compile_alone(signature: Any) -> Any:
        # Numba's own lock first: a thread with the file would wait for one that compiles, and that one for the file
        with compiler_lock.global_compiler_lock, _held(lock):
            return compile_now(signature)

    kept.load_overload, kept.save_overload, compiled.compile = load_whole, save_own, compile_alone


#: Locks of this process: a kernel may need itself for other arguments.
_own_locks: set[Path] = set()


@contextmanager
def _held(lock: Path) -> Iterator[None]:
    """Hold a file against other processes, for which one waits ``LONGEST_COMPILATION`` at most.

    A lock only saves work. Where there can be none one goes on without it.
    """
    if lock in _own_locks:
        yield
        return
    _own_locks.add(lock)
    descriptor = -1
    try:
        with suppress(OSError):
            # a pipe in its place would wait to be opened
            descriptor = os.open(lock, os.O_WRONLY | os.O_CREAT | os.O_NONBLOCK | os.O_NOFOLLOW, 0o666)
            latest = time.monotonic() + LONGEST_COMPILATION
            while time.monotonic() < latest:
                try:
                    fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                except BlockingIOError:
                    time.sleep(0.02)
        yield
    finally:
        _own_locks.discard(lock)
        if descriptor >= 0:
            os.close(descriptor)


@cache
def _say_once(folder: Path, what: str) -> None:
    _log.warning("machine code in %s %s", folder, what)


def _is_own(kind: Any) -> bool:
    """Whether a type, with its parts, is Numba's or of a class of this package."""
    made_by = getattr(kind, "instance_class", None)
    if made_by is not None and made_by.__module__.partition(".")[0] != __name__.partition(".")[0]:
        return False
    return all(map(_is_own, getattr(kind, "types", ())))


@cache
def cache_folder() -> Path | None:
    """The folder for machine code of these sources; None where nothing may be written, and a warning says so.

    In ``NUMBA_CACHE_DIR`` if that is set. A checkout keeps it in its own ``__pycache__``, else the user's cache does. A
    package that pip installed keeps it outside of itself, in the user's cache or in the environment's ``var/cache``, so
    that what pip removes is gone.
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
    _log.warning("no folder for machine code can be written, so kernels are compiled in every process")
    return None


def _bases() -> Iterator[Path]:
    if nb.config.CACHE_DIR:
        yield Path(nb.config.CACHE_DIR)
    installed = _PACKAGE.parent.name in ("site-packages", "dist-packages")
    if not installed:
        yield _PACKAGE / "__pycache__" / "machine_code"
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(home):
        yield Path(home) / "granular_response"
    if installed:
        yield Path(sys.prefix) / "var" / "cache" / "granular_response"


def source_digest() -> str:
    """Name of the present state of the sources."""
    digest = hashlib.sha256()
    for part in SOURCES:
        for path in sorted((_PACKAGE / part).rglob("*.py")):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
