"""Values kept in a folder under names made from what they depend on: rest states, and results of a sweep's tasks.

One file for each value, ``FOLDER/SOURCES/NAME.kept``: ``SOURCES`` is the key of the code that made it and ``NAME`` that
of what it was made from (see :mod:`.keys`), so nothing is found that this code would not make of this content. A file
is a pickle and a checksum over it and its name. What is damaged, stands under another name or belongs to another user
counts as absent, and that is said once.

A pickle can run code. Of states nothing is read but numbers, arrays and the classes of states, which run none.
Results of any other kind need all of pickle: a dataset of the smallest scene takes 130 times as long to write (93 ms
for 0.7), a reader that takes pickles too is none the safer for it, and so the folder is one that nobody else can write
to.

A memory is optional. What cannot be written or is of a kind that is not kept costs one warning, never the result.
A folder is the caller's to remove; rest states of other sources alone go by themselves (:meth:`Memory.clear`).
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import io
import os
import pickle
import re
import shutil
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ..inputs import read_bytes
from ..state import Box, Certificate, Contacts, Event, Reached, State
from ..store import atomic
from .keys import Indistinct, key, sources

#: Stands for a value that is not there.
MISSING: Any = object()

_SHELF = re.compile("[0-9a-f]{32}")
#: Endings of what stands on a shelf.
_OURS = (".kept", ".lock")
#: Seconds after which values of other sources go.
_OLD = 7 * 24 * 3600.0

#: What a pickle of states names: their classes, and what numpy makes arrays and numbers with.
_OF_STATES = {(one.__module__, one.__qualname__) for one in (Box, Certificate, Contacts, Event, Reached, State)} | {
    ("numpy", "dtype"),
    ("numpy", "ndarray"),
    *((f"numpy.{core}.multiarray", name) for core in ("core", "_core") for name in ("_reconstruct", "scalar")),
    *((f"numpy.{core}.numeric", "_frombuffer") for core in ("core", "_core")),
}


class MemoryWarning(UserWarning):
    """Something is computed but not kept."""


class _OfStates(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        if (module, name) not in _OF_STATES:
            raise pickle.UnpicklingError(f"{module}.{name} is no part of a state")
        return super().find_class(module, name)


class Memory:
    """Values that the present sources make, in a folder, which is made with the first value.

    ``parts`` are the sources that make the values, as :func:`.keys.sources` takes them; all, with those of
    ``packages``, if none is named. ``states``: values are states and texts, in tuples or alone, and reading one runs
    no code.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        parts: Sequence[str] = (),
        packages: Sequence[str] = (),
        *,
        states: bool = False,
    ) -> None:
        self.folder = Path(folder).absolute()  # also where it is used: in a worker process
        self.shelf = self.folder / sources(*(parts or ("", *packages)))
        self.packages, self.states = packages, states
        self._code: dict[str, str] = {}  # that of modules of the user's, as this process first found it

    def name(self, *values: Any) -> str | None:
        """The key of values; None, with a MemoryWarning, where they cannot be told from others."""
        try:
            return key(*values, packages=self.packages, code=self._code)
        except Indistinct as error:
            warn(f"{self.folder}: {error}, so results are not kept")
            return None

    def has(self, name: str | None) -> bool:
        """Whether there is a file for a value."""
        return name is not None and os.path.isfile(self._path(name))

    def load(self, name: str | None) -> Any:
        """The value under a name, or MISSING."""
        if name is None:
            return MISSING
        path = self._path(name)
        try:
            for one in (self.folder, self.shelf, path):
                if (owner := one.stat().st_uid) != os.getuid():
                    warn(f"{self.folder}: what another user owns is not read (user {owner}, this is {os.getuid()})")
                    return MISSING
            data = read_bytes(path)
        except FileNotFoundError:
            return MISSING
        except OSError as error:
            warn(f"{self.folder}: kept results cannot be read and are computed again: {error.strerror}")
            return MISSING
        if data[-32:] != _seal(name, data[:-32]):
            warn(f"{self.folder}: damaged results are computed again")
            return MISSING
        try:
            return (_OfStates if self.states else pickle.Unpickler)(io.BytesIO(data[:-32])).load()
        except Exception as error:  # its classes are no longer there, or it is none of ours
            warn(f"{self.folder}: results that cannot be read are computed again: {type(error).__name__}: {error}")
            return MISSING

    def save(self, name: str, value: Any) -> None:
        """Keep a value, unless it cannot be kept: then a MemoryWarning says why, once for each reason."""
        try:
            data = pickle.dumps(value, protocol=5)
        except Exception as error:  # whatever the methods of a value raise
            warn(f"{self.folder}: a value is not kept: {error}")
            return
        try:
            atomic.make_folder(self._path(name))
            # by its seal a file is known that was lost in part
            atomic.write_bytes(self._path(name), data + _seal(name, data), lasting=False)
        except OSError as error:
            warn(f"{self.folder}: nothing more is kept there: {error.strerror or error}")

    def save_result(self, name: str | None, result: Any, function: Callable, value: Any) -> None:
        """Keep ``function(value)`` under its name, unless what it depends on, a table of disks, changed meanwhile."""
        if name is None:
            return
        if self.name(function, value) == name:
            self.save(name, result)
        else:
            warn(f"{self.folder}: a file that a task reads changed while it ran, so its result is not kept")

    @contextlib.contextmanager
    def making(self, name: str) -> Iterator[None]:
        """Let one process at a time make the value of a name, where the file system has locks."""
        lock = self.shelf / f"{name}.lock"
        held = None
        with contextlib.suppress(OSError):
            atomic.make_folder(lock)
            # a pipe in its place would wait to be opened
            held = os.open(lock, os.O_WRONLY | os.O_CREAT | os.O_NONBLOCK | os.O_NOFOLLOW, 0o600)
            fcntl.flock(held, fcntl.LOCK_EX)
        try:
            yield
        finally:
            if held is not None:
                lock.unlink(missing_ok=True)  # whoever waits for it goes on, and finds the value
                os.close(held)

    def clear(self) -> None:
        """Remove what other sources have left and nobody has added to for a week."""
        with contextlib.suppress(OSError):
            for shelf in self.folder.iterdir():
                ours = _SHELF.fullmatch(shelf.name) and all(file.suffix in _OURS for file in shelf.iterdir())
                if ours and time.time() - shelf.stat().st_mtime > _OLD:
                    shutil.rmtree(shelf, ignore_errors=True)

    def _path(self, name: str) -> Path:
        return self.shelf / f"{name}.kept"


def warn(message: str) -> None:
    """One line about something that is computed but not kept; the same one is not said twice."""
    warnings.warn(" ".join(message.split()), MemoryWarning, stacklevel=1)


def _seal(name: str, data: bytes) -> bytes:
    return hashlib.sha256(name.encode() + data).digest()
