"""What goes to a worker process and what comes back: bytes both ways, made and read here.

So a worker and the pipes to it never meet a value that cannot be sent: an exception or a result of any kind ends in an
error of its task. Functions of a notebook cell and lambdas go by their code, others by their name (cloudpickle).
Warnings come back too, and are said once for all workers.
"""

from __future__ import annotations

import builtins
import contextlib
import functools
import pickle
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

import cloudpickle

from ..machine import threads
from .errors import failed, raised
from .memory import MemoryWarning

_HEARD: ContextVar[list[tuple[str, str, str, int]] | None] = ContextVar("heard", default=None)
#: What was said already, as the module ``warnings`` keeps it.
_SAID: dict[Any, Any] = {}


class WorkerError(RuntimeError):
    """An exception that cannot leave its worker; its text is the traceback."""


@dataclass(frozen=True)
class _Failure:
    """An exception as text, and as it is where that can be read elsewhere."""

    said: str
    trace: str
    error: bytes | None


def packed(index: int, items: Sequence[Any], value: Any) -> bytes:
    """The bytes of an item, or of the function of a sweep; raises SweepError if it cannot be sent."""
    try:
        return cloudpickle.dumps(value)
    except Exception as error:  # whatever its own methods raise
        raise failed(index, items, f"cannot be sent to a worker: {type(error).__name__}: {error}") from None


def run(function: bytes, item: bytes) -> bytes:
    """In a worker: call a packed function with a packed item."""
    with _listening() as heard, threads.using(1):  # whatever the process had that was forked
        outcome = _called(function, item)
    return pickle.dumps((outcome, heard))


def _called(function: bytes, item: bytes) -> bytes:
    """The packed result, or the packed failure."""
    try:
        return cloudpickle.dumps(_loaded(function)(pickle.loads(item)))
    except (Exception, SystemExit) as error:
        said, trace = f"{type(error).__name__}: {error}", "".join(traceback.format_exception(error))
        try:
            carried = cloudpickle.dumps(error)
            pickle.loads(carried)
        except Exception:
            carried = None
        return pickle.dumps(_Failure(said, trace, carried))


def unpacked(index: int, items: Sequence[Any], outcome: bytes) -> Any:
    """The result of a task; raises SweepError if it raised, or returned what cannot be read here."""
    outcome, heard = pickle.loads(outcome)
    for text, category, file, line in heard:
        warnings.warn_explicit(text, _category(category), file, line, registry=_SAID)
    try:
        result = pickle.loads(outcome)
    except Exception as error:
        raise raised(index, items, error, f"its result cannot be read: {type(error).__name__}: {error}") from error
    if not isinstance(result, _Failure):
        return result
    cause: BaseException = WorkerError(result.trace)
    if result.error is not None:
        try:
            cause = pickle.loads(result.error)
            cause.add_note(result.trace)
        except Exception:  # it can be read in the worker, not here
            cause = WorkerError(result.trace)
    raise raised(index, items, cause, result.said) from cause


@contextlib.contextmanager
def _listening() -> Iterator[list[tuple[str, str, str, int]]]:
    """The warnings of a block, in this thread, in place of their lines on standard error."""
    heard: list[tuple[str, str, str, int]] = []
    if not getattr(warnings.showwarning, "listens", False):
        warnings.showwarning = _ear(warnings.showwarning)
    token = _HEARD.set(heard)
    try:
        yield heard
    finally:
        _HEARD.reset(token)


def _ear(before: Callable[..., None]) -> Callable[..., None]:
    """A ``warnings.showwarning`` that keeps what somebody listens to; threads of a worker do not hear each other."""

    def show(message: Warning | str, category: type[Warning], filename: str, lineno: int, *rest: Any) -> None:
        heard = _HEARD.get()
        if heard is None:
            before(message, category, filename, lineno, *rest)
        else:
            heard.append((str(message), category.__name__, filename, lineno))

    show.listens = True  # type: ignore[attr-defined]
    return show


def _category(name: str) -> type[Warning]:
    """The category of a name: one of Python's or of this package's, else a UserWarning."""
    kind = {"MemoryWarning": MemoryWarning}.get(name) or getattr(builtins, name, None)
    return kind if isinstance(kind, type) and issubclass(kind, Warning) else UserWarning


@functools.lru_cache(maxsize=4)
def _loaded(function: bytes) -> Callable[[Any], Any]:
    return pickle.loads(function)
