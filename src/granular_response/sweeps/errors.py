"""What goes wrong with a sweep, in one line that names the task."""

from __future__ import annotations

import functools
import inspect
import numbers
import reprlib
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..errors import GranularError

#: Most characters by which a message names a task, and most tasks that it is told from.
_LONGEST, _COMPARED = 400, 100


class SweepError(GranularError, RuntimeError):
    """A sweep that cannot go on. One line; ``__cause__`` is the exception of the task, if any."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


def interrupted(message: str) -> KeyboardInterrupt:
    """The interruption of a sweep: where nobody handles it, Python ends with this line and without a traceback."""
    error = KeyboardInterrupt(message)
    error._render_traceback_ = lambda: [f"interrupted; {message}"]  # type: ignore[attr-defined]  # asked by notebooks
    _end_in_one_line()
    return error


@functools.cache
def _end_in_one_line() -> None:
    usual = sys.excepthook

    def say(kind: type[BaseException], error: BaseException, trace: Any) -> None:
        if isinstance(error, KeyboardInterrupt) and hasattr(error, "_render_traceback_"):
            print(f"interrupted; {error}", file=sys.stderr)
        else:
            usual(kind, error, trace)

    sys.excepthook = say


def failed(index: int, items: Sequence[Any], problem: str) -> SweepError:
    """The error of one task, named by what tells it from the others."""
    own, others = parts(items[index]), [parts(one) for k, one in enumerate(items[:_COMPARED]) if k != index]
    differs = {name: value for name, value in own.items() if any(one.get(name) != value for one in others)}
    said = ", ".join(f"{name} = {value}" for name, value in (differs or own).items()) or reprlib.repr(items[index])
    said = said if len(said) <= _LONGEST else f"{said[: _LONGEST - 3]}..."
    return SweepError(f"task {index + 1} of {len(items)} ({said}) {problem}")


def raised(
    index: int, items: Sequence[Any], error: BaseException, said: str | None = None, came: str = "failed"
) -> SweepError:
    """The error of a task that raised; ``said`` is what the exception says, if not its type and text."""
    failure = failed(index, items, f"{came}: {said or f'{type(error).__name__}: {error}'}")
    failure.__cause__ = error
    return failure


def parts(item: Any) -> dict[str, str]:
    """Keys of a scene that are not at their defaults, and named arguments of a call that are short, with their values.

    Examples
    --------
    >>> from granular_response.scene import Contact, Scene
    >>> parts(Scene(contact=Contact(friction=0.5)))
    {'contact.friction': '0.5'}
    >>> parts(functools.partial(round, 1.25, ndigits=1))
    {'number': '1.25', 'ndigits': '1'}
    """
    from ..scene.base import Description  # here: command lines import this module at their start
    from ..scene.errors import show

    def keys(key: str, value: Any) -> Iterator[tuple[str, str]]:
        if isinstance(value, Description):
            value = value.model_dump(mode="json", exclude_defaults=True)
        elif not isinstance(value, Mapping) or not value:
            yield key, show(value)
            return
        for name, one in value.items():
            yield from keys(f"{key}.{name}" if key else name, one)

    if isinstance(item, Description):
        return dict(keys("", item))
    if not isinstance(item, functools.partial):
        return {}
    try:
        given = inspect.signature(item.func).bind_partial(*item.args, **item.keywords).arguments
    except (TypeError, ValueError):  # a function of C without a signature
        given = {f"argument {k}": value for k, value in enumerate(item.args)} | item.keywords
    found: dict[str, str] = {}
    for name, value in given.items():
        many = value if isinstance(value, (list, tuple)) else [value]
        if isinstance(value, Description):
            found |= keys("", value)
        elif all(isinstance(one, (numbers.Number, str)) or one is None for one in many):
            found[name] = show(list(many) if many is value else value)
    return found
