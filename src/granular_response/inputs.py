"""Files that are read: regular ones, whole, as text in UTF-8 or as JSON."""

from __future__ import annotations

import errno
import json
import os
import stat
from pathlib import Path
from typing import Any


def check_regular(path: str | os.PathLike[str]) -> None:
    """Raise the OSError of what cannot be read whole: nothing there, a folder, a device or a pipe (no end)."""
    kind = os.stat(path).st_mode
    if stat.S_ISDIR(kind):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if not stat.S_ISREG(kind):
        raise OSError(errno.EINVAL, "is not a regular file", os.fspath(path))


def read_text(path: Path) -> str:
    """The text of a file, without a mark of byte order, with line ends as they are. OSError, UnicodeError."""
    check_regular(path)
    return path.read_bytes().decode("utf-8-sig")


def read_json(path: Path) -> Any:
    """What a file of JSON holds. OSError; ValueError for anything else, also what is nested too deeply."""
    try:
        return json.loads(read_text(path))
    except RecursionError:
        raise ValueError("lists or mappings are nested too deeply") from None
