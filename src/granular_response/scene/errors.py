"""One line per mistake: the key, the value found there and what is allowed."""

from __future__ import annotations

import difflib
import re
import reprlib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from ..errors import GranularError

_MISSING: Any = object()

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


class Problem(GranularError, ValueError):
    """What is wrong with a value, raised inside a validator; pydantic adds where it stands.

    ``key`` extends the path of the validated object and ``value`` replaces its input in the message.
    """

    def __init__(self, allowed: str, *, key: Sequence[str | int] = (), value: Any = _MISSING) -> None:
        super().__init__(allowed)
        self.allowed, self.key, self.value = allowed, tuple(key), value


def suggestion(word: object, choices: Iterable[str]) -> str:
    """', did you mean ...?' for the choice nearest to ``word``, or nothing if none is near."""
    near = difflib.get_close_matches(word, list(choices), n=1) if isinstance(word, str) else []
    return f", did you mean {near[0]}?" if near else ""


def show(value: object) -> str:
    """``value`` on one line, spelled as YAML where Python differs, and cut where it is long."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return _short.repr(value)


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


def from_validation(error: ValidationError, kinds: Iterable[str], units: Mapping[str, str]) -> SceneError:
    """The first mistake that pydantic found, with the number of further ones.

    ``kinds`` are the tags that pydantic puts in the path of a tagged union and that no scene file has; ``units`` are
    those of keys, for numbers that are given with a unit.
    """
    found = error.errors(include_url=False)
    first = found[0]
    found_at = first["loc"]
    tags = tuple(kinds)
    path = tuple(part for k, part in enumerate(found_at) if not (k and found_at[k - 1] == "packing" and part in tags))
    value = first["input"]
    problem = first.get("ctx", {}).get("error")
    if first["type"] == "missing":
        message = f"{show_key(path)}: missing, must be given"
    elif isinstance(problem, Problem):
        value = value if problem.value is _MISSING else problem.value
        message = describe(path + problem.key, value, problem.allowed)
    elif first["type"] == "literal_error":
        choices = re.findall(r"'([^']*)'", first["ctx"]["expected"])
        message = describe(path, value, f"must be {' or '.join(choices)}{suggestion(value, choices)}")
    else:
        said = first["msg"].replace("Input should be", "must be")
        message = describe(path, value, said.replace("valid tuple", "list").replace("valid dictionary", "mapping"))
    unit = units.get(str(path[-1]) if path else "", "")
    if unit and isinstance(value, str) and re.match(r"\s*[-+]?(?!0x)\.?\d[\d.]*(e[-+]?\d+)?\s*[a-zµ]", value, re.I):
        message += f"; the unit is {unit}, gr.LaboratoryUnits converts"
    more = len(found) - 1
    return SceneError(message + (f" (and {more} more mistake{'s' * (more > 1)})" if more else ""))
