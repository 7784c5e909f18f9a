"""Values kept in a folder under names made from what they depend on: rest states, and results of a sweep's tasks.

One file for each value, ``FOLDER/SOURCES/NAME.kept``: ``SOURCES`` is the key of the code that made it and ``NAME`` that
of what it was made from (see :mod:`.keys`), so nothing is found that this code would not make of this content. Files
are sealed pickles: what is damaged or stands under another name counts as absent. A pickle can hold code, so a folder
is one that nobody else can write to.

A memory is optional. What cannot be written or is of a kind that is not kept costs one warning, never the result.
A folder is the caller's to remove; rest states of other sources alone go by themselves (:meth:`Memory.clear`).
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import re
import shutil
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from ..inputs import read_bytes
from ..store import atomic
from .keys import Indistinct, key, sources

Value = TypeVar("Value")

#: Stands for a value that is not there.
MISSING: Any = object()

_SHELF = re.compile("[0-9a-f]{32}")
#: Seconds after which values of other sources go.
_OLD = 7 * 24 * 3600.0


class MemoryWarning(UserWarning):
    """Something is computed but not kept."""


class Memory:
    """Values that the present sources make, in a folder, which is made with the first value.

    ``parts`` are the sources that make the values, as :func:`.keys.sources` takes them; all, with those of
    ``packages``, if none is named.
    """

    def __init__(self, folder: str | os.PathLike[str], parts: Sequence[str] = (), packages: Sequence[str] = ()) -> None:
        self.folder = Path(folder).absolute()  # also where it is used: in a worker process
        self.shelf = self.folder / sources(*(parts or ("", *packages)))
        self.packages = packages

    def name(self, *values: Any) -> str | None:
        """The key of values; None, with a MemoryWarning, where they cannot be told from others."""
        try:
            return key(*values, packages=self.packages)
        except Indistinct as error:
            warn(f"{self.folder}: {error}, so results are not kept")
            return None

    def result(self, function: Callable[[Value], Any], value: Value) -> Any:
        """``function(value)``, kept or computed."""
        name = self.name(function, value)
        found = self.load(name)
        if found is MISSING:
            found = function(value)
            self.save_result(name, found, function, value)
        return found

    def load(self, name: str | None) -> Any:
        """The value under a name, or MISSING."""
        if name is None:
            return MISSING
        try:
            data = read_bytes(self._path(name))
            return pickle.loads(data[:-32]) if data[-32:] == _seal(name, data[:-32]) else MISSING
        except Exception:  # there is none, or its classes are no longer there
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
        """Keep ``function(value)`` under its name, unless the value, a table of disks, has changed meanwhile."""
        if name is not None and self.name(function, value) == name:
            self.save(name, result)

    def clear(self) -> None:
        """Remove what other sources have left and nobody has added to for a week."""
        with contextlib.suppress(OSError):
            for shelf in self.folder.iterdir():
                ours = _SHELF.fullmatch(shelf.name) and all(file.suffix == ".kept" for file in shelf.iterdir())
                if ours and time.time() - shelf.stat().st_mtime > _OLD:
                    shutil.rmtree(shelf, ignore_errors=True)

    def _path(self, name: str) -> Path:
        return self.shelf / f"{name}.kept"


def warn(message: str) -> None:
    """One line about something that is computed but not kept; the same one is not said twice."""
    warnings.warn(" ".join(message.split()), MemoryWarning, stacklevel=3)


def _seal(name: str, data: bytes) -> bytes:
    return hashlib.sha256(name.encode() + data).digest()
