"""Files that are read: regular ones, whole, as bytes, as text in UTF-8 or as JSON. Nothing else opens one to read."""

from __future__ import annotations

import errno
import json
import os
import stat
from pathlib import Path
from typing import Any


def check_regular(path: str | os.PathLike[str], opened: int | None = None) -> None:
    """Raise the OSError of what cannot be read whole: nothing there, a folder, a device or a pipe (no end).

    What is looked at is the file that was ``opened``, or what has the name now.
    """
    kind = os.stat(path if opened is None else opened).st_mode
    if stat.S_ISDIR(kind):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if not stat.S_ISREG(kind):
        raise OSError(errno.EINVAL, "is not a regular file", os.fspath(path))


def unreadable(error: OSError | ValueError) -> str:
    """Why a file cannot be read, in words."""
    if isinstance(error, FileNotFoundError):
        return "no such file"
    if isinstance(error, UnicodeEncodeError):
        return "has a name that this locale cannot spell"
    if isinstance(error, UnicodeDecodeError):
        return "is not a text file in UTF-8"
    return f"cannot be read: {getattr(error, 'strerror', None) or error}"


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """What a regular file holds; what was opened is looked at, so nothing else can take its place. OSError."""
    # a pipe would wait to be opened
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        check_regular(path, descriptor)
        with open(descriptor, "rb", closefd=False) as file:
            return file.read()
    finally:
        os.close(descriptor)


def read_text(path: Path) -> str:
    """The text of a file, without a mark of byte order, with line ends as they are. OSError, UnicodeError."""
    return read_bytes(path).decode("utf-8-sig")


def read_json(path: Path) -> Any:
    """What a file of JSON holds. OSError; ValueError for anything else, also what is nested too deeply."""
    try:
        return json.loads(read_text(path))
    except RecursionError:
        raise ValueError("lists or mappings are nested too deeply") from None
