"""What a computation may use beside its arguments: processes, an executor, and folders that remember.

Studies call ``map_tasks`` and ``rest_state`` deep inside; who starts a study says once what these find:

    with using(workers=4, checkpoint="kept/study", rest_states="kept/rest"):
        study()

It holds within the block, in this thread, and for rest states in the worker processes of its sweeps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

#: The name under which a progress is told how many tasks a checkpoint had, before the first one begins.
KEPT = "kept"


#: Anything that wants to know how far a computation is: ``progress(done, total, "load paths")``.
Progress = Callable[[float, float, str], Any]


@dataclass(frozen=True)
class Resources:
    """What is there to be used; None: nothing of the kind."""

    workers: int | None = None  #: number of local processes; None: all cores
    executor: Executor | None = None  #: in place of local processes
    progress: Progress | None = None  #: who is told how far each sweep is
    checkpoint: Path | None = None  #: folder for the results of finished tasks
    rest_states: Path | None = None  #: folder for states at rest
    packages: tuple[str, ...] = ()  #: whose code makes what is kept, beside this one


_CURRENT: ContextVar[Resources] = ContextVar("resources", default=Resources())  # noqa: B039, it is frozen


def current() -> Resources:
    """What is in use here."""
    return _CURRENT.get()


@contextmanager
def using(**given: Any) -> Iterator[Resources]:
    """Use ``given`` fields of :class:`Resources` within the block, and what was in use before for the others."""
    token = _CURRENT.set(replace(current(), **given))
    try:
        yield current()
    finally:
        _CURRENT.reset(token)
