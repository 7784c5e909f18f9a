"""Tasks over an executor: that of processes of this machine, or that of a Dask cluster.

What goes to a worker process and what comes back are bytes, made and read here. So a worker and the pipes to it never
meet a value that cannot be sent: an exception or a result of any kind ends in an error of its task. Functions of a
notebook cell and lambdas go by their code, others by their name (cloudpickle). Warnings come back too, and are said
once for all workers.
"""

from __future__ import annotations

import functools
import pickle
import traceback
import warnings
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

import cloudpickle

from ..machine import threads
from .errors import failed, raised

#: Seconds without a result after which ``idle`` is called.
PATIENCE = 10.0

#: What was said already, as the module ``warnings`` keeps it.
_SAID: dict[Any, Any] = {}


class WorkerError(RuntimeError):
    """An exception that cannot leave its worker; its text is the traceback."""


def results(
    executor: Executor,
    function: Callable,
    items: Sequence[Any],
    waiting: deque[int],
    running: dict[Future, int],
    *,
    ahead: int,
    idle: Callable[[], None] = lambda: None,
) -> Generator[tuple[int, Any], None, None]:
    """Results of the tasks ``waiting`` with their index, as they come; no more than ``ahead`` are handed out at once.

    What is handed out goes from ``waiting`` to ``running``, and leaves that with its result. Raises SweepError for a
    task that fails, and what the executor raises if it cannot go on.
    """
    sent = _packed(waiting[0], items, function)
    while waiting or running:
        while waiting and len(running) < ahead:
            index = waiting[0]
            running[executor.submit(_run, sent, _packed(index, items, items[index]))] = index
            waiting.popleft()
        done = wait(running, timeout=PATIENCE, return_when=FIRST_COMPLETED).done
        if not done:
            idle()
        while done:
            future = done.pop()
            outcome, index = future.result(), running[future]
            del running[future], future  # nobody holds what came of it any longer
            yield index, _unpacked(index, items, outcome)


def _packed(index: int, items: Sequence[Any], value: Any) -> bytes:
    """The bytes of an item, or of the function of a sweep; raises SweepError if it cannot be sent."""
    try:
        return cloudpickle.dumps(value)
    except Exception as error:  # whatever its own methods raise
        raise failed(index, items, f"cannot be sent to a worker: {type(error).__name__}: {error}") from None


def _run(function: bytes, item: bytes) -> bytes:
    """In a worker: call a packed function with a packed item."""
    with warnings.catch_warnings(record=True) as heard, threads.using(1):  # whatever the process had that was forked
        said, body = _called(function, item)
    lines = [(str(one.message), one.category, one.filename, one.lineno) for one in heard]
    return cloudpickle.dumps((said, body, lines))


def _called(function: bytes, item: bytes) -> tuple[str | None, bytes]:
    """None and the packed result, or what an exception says and the packed exception."""
    try:
        return None, cloudpickle.dumps(_loaded(function)(pickle.loads(item)))
    except (Exception, SystemExit) as error:
        said, trace = f"{type(error).__name__}: {error}", "".join(traceback.format_exception(error))
        try:
            error.add_note(trace)
            body = cloudpickle.dumps(error)
            pickle.loads(body)
        except Exception:
            body = pickle.dumps(WorkerError(trace))
        return said, body


def _unpacked(index: int, items: Sequence[Any], outcome: bytes) -> Any:
    """The result of a task; raises SweepError if it raised, or returned what cannot be read here."""
    said, body, lines = pickle.loads(outcome)
    for text, category, file, line in lines:
        warnings.warn_explicit(text, category, file, line, registry=_SAID)
    try:
        value = pickle.loads(body)
    except Exception as error:
        said = said or f"its result cannot be read: {type(error).__name__}: {error}"
        raise raised(index, items, error, said) from error
    if said is None:
        return value
    raise raised(index, items, value, said) from value


@functools.lru_cache(maxsize=4)
def _loaded(function: bytes) -> Callable[[Any], Any]:
    return pickle.loads(function)
