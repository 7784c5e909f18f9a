"""One line per mistake: the key, the value found there and what is allowed."""

from __future__ import annotations

import difflib
import re
import reprlib
from collections.abc import Iterable, Sequence
from typing import Any

from ..errors import GranularError

#: In place of a value that was not given.
MISSING: Any = object()

_short = reprlib.Repr()
_short.maxstring = _short.maxother = 60
_short.maxlong = 40
_short.maxlevel = 3


class SceneError(GranularError, ValueError):
    """A scene that cannot be simulated as written. The message is one line: key, value, what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.splitlines()))


class SceneFileError(SceneError, OSError):
    """A scene file, or a table of disks, that cannot be read."""


class NotAllowed(GranularError, ValueError):
    """What is wrong with a value, raised inside a validator; pydantic adds where it stands.

    ``key`` extends the path of the validated object and ``value`` replaces its input in the message.
    """

    def __init__(self, allowed: str, *, key: Sequence[str | int] = (), value: Any = MISSING) -> None:
        super().__init__(allowed)
        self.allowed, self.key, self.value = allowed, tuple(key), value


def must(met: object, allowed: str, *, key: Sequence[str | int] = (), value: Any = MISSING) -> None:
    """Raise NotAllowed unless a condition is ``met``."""
    if not met:
        raise NotAllowed(allowed, key=key, value=value)


def suggestion(word: object, choices: Iterable[str]) -> str:
    """', did you mean ...?' for the choice nearest to ``word``, or nothing if none is near."""
    near = difflib.get_close_matches(word, list(choices), n=1) if isinstance(word, str) else []
    return f", did you mean {near[0]}?" if near else ""


def show(value: object) -> str:
    """``value`` on one line, spelled as YAML where Python differs, and cut where it is long."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return re.sub(r"\s*\n\s*", " ", _short.repr(value))  # an array is several lines


def show_key(path: Iterable[str | int]) -> str:
    """Dotted path of a key: ``loads[0].force``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += ("." if text else "") + (part if re.fullmatch(r"[\w\-]+", part) else show(part))
    return text


def describe(path: Iterable[str | int], value: object, allowed: str) -> str:
    """The one line itself."""
    key = show_key(path)
    return f"{key} = {show(value)}: {allowed}" if key else f"{show(value)}: {allowed}"
