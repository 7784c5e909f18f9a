"""What goes wrong with a sweep, in one line that names the task."""

from __future__ import annotations

import functools
import inspect
import numbers
import reprlib
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..errors import GranularError

if TYPE_CHECKING:
    from ..scene.base import Description

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

    if isinstance(item, Description):
        return dict(_keys(item))
    return dict(_arguments(item)) if isinstance(item, functools.partial) else {}


def _keys(described: Description) -> Iterator[tuple[str, str]]:
    from ..scene.errors import show

    waiting = list(described.model_dump(mode="json", exclude_defaults=True).items())
    while waiting:
        key, value = waiting.pop(0)
        if isinstance(value, Mapping) and value:
            waiting[:0] = [(f"{key}.{name}", one) for name, one in value.items()]
        else:
            yield key, show(value)


def _arguments(call: functools.partial) -> Iterator[tuple[str, str]]:
    from ..scene.base import Description
    from ..scene.errors import show

    try:
        given = inspect.signature(call.func).bind_partial(*call.args, **call.keywords).arguments
    except (TypeError, ValueError):  # a function of C without a signature
        given = {f"argument {k}": value for k, value in enumerate(call.args)} | call.keywords
    for name, value in given.items():
        if isinstance(value, Description):
            yield from _keys(value)
        elif isinstance(value, (numbers.Number, str)) or value is None:
            yield name, show(value)
        elif isinstance(value, (list, tuple)) and all(isinstance(one, (numbers.Number, str)) for one in value):
            yield name, show(list(value))
