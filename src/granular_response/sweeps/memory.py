"""Values kept in a folder under names made from what they depend on: rest states, and results of a sweep's tasks.

One file for each value, ``FOLDER/SOURCES/NAME.kept``: ``SOURCES`` names the code that made it and ``NAME`` the content
that it was made from (see :mod:`.digest`), so nothing is found that this code would not make of this content. Files
hold no code (see :mod:`.encoding`) and are sealed: what is damaged or stands under another name counts as absent.

A memory is optional. What cannot be written or is of a kind that is not kept costs one warning, never the result.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import time
import warnings
from collections.abc import Collection
from pathlib import Path
from typing import Any

from ..store import atomic
from .encoding import NotDecodable, NotEncodable, decode, encode

#: Stands for a value that is not there.
MISSING: Any = object()

_SHELF = re.compile("[0-9a-f]{32}")
#: Seconds after which values of other sources go.
_OLD = 7 * 24 * 3600.0


class MemoryWarning(UserWarning):
    """Something is computed but not kept."""


class Memory:
    """Values of one state of the sources in a folder.

    Parameters
    ----------
    folder
        Is made if it is not there, with the first value.
    sources
        Name of the code that makes the values, from :func:`.digest.sources`.
    modules
        Whose classes values may be of, beside those of this package; a package stands for all of its modules.
    """

    def __init__(self, folder: str | os.PathLike[str], sources: str, modules: Collection[str] = ()) -> None:
        self.folder = Path(folder)
        self.shelf = self.folder / sources
        self.modules = modules

    def load(self, name: str) -> Any:
        """The value under a name, or MISSING."""
        try:
            data = self._path(name).read_bytes()
            if data[-32:] != _seal(name, data[:-32]):
                return MISSING
            return decode(data[:-32], self.modules)
        except (OSError, NotDecodable):
            return MISSING

    def save(self, name: str, value: Any) -> None:
        """Keep a value, unless it cannot be kept: then a MemoryWarning says why, once for each reason."""
        try:
            data = encode(value, self.modules)
            if not self.shelf.is_dir():
                self._clear()
                self.shelf.mkdir(parents=True, exist_ok=True)
            atomic.write_bytes(self._path(name), data + _seal(name, data))
        except NotEncodable as error:
            warn(f"{self.folder}: {error}")
        except OSError as error:
            warn(f"{self.folder}: nothing more is kept there: {error.strerror or error}")

    def _path(self, name: str) -> Path:
        return self.shelf / f"{name}.kept"

    def _clear(self) -> None:
        """Remove what other sources have left and nobody has added to for a week."""
        with contextlib.suppress(OSError):
            for shelf in self.folder.iterdir():
                ours = _SHELF.fullmatch(shelf.name) and all(file.suffix == ".kept" for file in shelf.iterdir())
                if ours and time.time() - shelf.stat().st_mtime > _OLD:
                    shutil.rmtree(shelf, ignore_errors=True)


def warn(message: str) -> None:
    """One line about something that is computed but not kept; the same one is not said twice."""
    warnings.warn(" ".join(message.split()), MemoryWarning, stacklevel=3)


def _seal(name: str, data: bytes) -> bytes:
    return hashlib.sha256(name.encode() + data).digest()
