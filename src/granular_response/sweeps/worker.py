"""What goes to a worker process and what comes back: bytes both ways, made and read here.

So a worker and the pipes to it never meet a value that cannot be sent: an exception or a result of any kind ends in an
error of its task. Functions of a notebook cell and lambdas go by their code, others by their name (cloudpickle).
"""

from __future__ import annotations

import functools
import pickle
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cloudpickle

from .errors import failed, raised


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


@functools.lru_cache(maxsize=4)
def _loaded(function: bytes) -> Callable[[Any], Any]:
    return pickle.loads(function)
