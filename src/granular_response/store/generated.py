"""Generated lines in a file that is otherwise written by hand.

They stand between two marker lines, ``<!-- NAME: begin -->`` and ``<!-- NAME: end -->``; the rest is left alone.
"""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import GranularError
from ..inputs import read_text
from . import atomic


class GeneratedError(GranularError):
    """A file without a place for generated lines. The message is one line."""


def markers(name: str) -> tuple[str, str]:
    """The two marker lines."""
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def replace(text: str, name: str, lines: str) -> str:
    """``text`` with ``lines`` between the markers of ``name``.

    Raises GeneratedError if the markers are not there, once each and in order.
    """
    begin, end = markers(name)
    if text.count(begin) != 1 or text.count(end) != 1 or text.index(begin) > text.index(end):
        raise GeneratedError(f"the lines {begin} and {end} must be there once, in this order")
    before, rest = text.split(begin)
    return f"{before}{begin}\n{lines}\n{end}{rest.split(end)[1]}"


def renew(file: str | os.PathLike[str], name: str, lines: str) -> None:
    """Renew the generated lines of a file. Raises GeneratedError if it cannot be read or has no place for them."""
    path = Path(file)
    try:
        before = read_text(path)
        after = replace(before, name, lines)
    except (OSError, ValueError, GeneratedError) as error:
        raise GeneratedError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    if after != before:
        atomic.write_bytes(path, after.encode())
