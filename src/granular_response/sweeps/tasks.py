"""One map over independent tasks: in this process, over local processes, or over a Dask cluster.

A task is a function of one argument, of a module, a notebook or a lambda, that draws random numbers only from seeds in
its item. A script that calls ``map_tasks`` has its own calls under ``if __name__ == "__main__":``, since workers import
it.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import reprlib
from collections.abc import Callable, Generator, Iterable, Sequence
from pathlib import Path
from typing import Any, SupportsIndex, TypeVar

from ..machine import threads
from .cluster import over_dask
from .errors import SweepError, raised
from .memory import MISSING, Memory
from .processes import over_processes
from .resources import Progress as Progress
from .resources import Resources, current, using

LOG = logging.getLogger("granular_response")

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Environment variable with the address of a running Dask scheduler, the one that Dask itself reads.
SCHEDULER_VARIABLE = "DASK_SCHEDULER_ADDRESS"


def map_tasks(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    parts: Sequence[str] = (),
    what: str = "tasks",
) -> list[Result]:
    """Results of ``function`` for all items, in the order of the items and the same wherever they are computed.

    An interrupted call with a checkpoint continues where it was; a worker that dies costs only the task it was at.

    Parameters
    ----------
    function, items : the task and its arguments.
    workers : number of local processes; this process if 1. If None, that of the :mod:`.resources` in use, else all
        cores.
    scheduler : address of a Dask scheduler (``tcp://host:8786``). If None, the resources in use and
        ``DASK_SCHEDULER_ADDRESS`` are asked.
    progress : called as ``progress(done, total, what)`` at the start and after each task; if None, that of the
        resources. Where a checkpoint had some of the results, ``what`` says how many.
    checkpoint : folder in which the result of each finished task is kept until the caller removes it. A later call
        finds it there if function, item and the sources of this package, and of those that the resources in use name,
        are the same (see :mod:`.keys`). Of a lambda or a function of a notebook nothing is kept. If None, that of the
        resources in use; nothing is kept if there is none either.
    parts : the sources that the results depend on, as :func:`.keys.sources` takes them; all if none is named.
    what : what the tasks are, for the progress line.

    Raises SweepError for a set of items, which has no order; if a task raises (the message names its item), if workers
    keep dying at one task, if something cannot be sent to a worker or back, or if the cluster cannot be reached or is
    lost.

    Examples
    --------
    >>> gr.map_tasks(abs, [-1, 2], workers=1)
    [1, 2]
    """
    given = current()
    workers, progress = given.workers if workers is None else workers, progress or given.progress
    if workers is not None and not (isinstance(workers, SupportsIndex) and workers.__index__() >= 1):
        raise SweepError(f"workers = {workers!r}: must be a whole number, 1 or more")
    if isinstance(items, (set, frozenset)):
        raise SweepError(f"items = {reprlib.repr(items)}: must be a list, a set has no order for the results to be in")
    items = list(items)
    scheduler = scheduler or given.scheduler or os.environ.get(SCHEDULER_VARIABLE) or None
    folder = checkpoint or given.checkpoint
    memory = Memory(folder, parts, given.packages) if folder and items else None
    names = [memory.name(function, item) if memory else None for item in items]
    results: list[Any] = [memory.load(name) if memory else MISSING for name in names]
    todo = [index for index, result in enumerate(results) if result is MISSING]
    done = len(items) - len(todo)
    if done:
        what = f"{what}, {done} of {len(items)} taken from the checkpoint"
        LOG.info("%s", what)
    if progress:
        progress(done, len(items), what)
    if not todo:
        return results
    count = min(workers or threads.cores(), len(todo))
    # the nodes of a cluster may not share the folder
    task = functools.partial(_alone, function, None if scheduler else given.rest_states)
    if scheduler:
        finished = over_dask(task, items, todo, scheduler)
    elif count == 1 and workers in (1, None):
        finished = _here(task, items, todo)
    else:
        finished = over_processes(task, items, todo, count, _module(function))
    with contextlib.closing(finished):  # whatever goes wrong below ends the workers at once
        for index, result in finished:
            results[index] = result
            if memory:
                memory.save_result(names[index], result, function, items[index])
            done += 1
            if progress:
                progress(done, len(items), what)
    return results


def _alone(function: Callable, rest_states: Path | None, item: Any) -> Any:
    """Call a function where it may use ``rest_states`` and nothing else of the resources."""
    with using(**vars(Resources(rest_states=rest_states))):
        return function(item)


def _here(function: Callable, items: Sequence[Any], todo: Sequence[int]) -> Generator[tuple[int, Any], None, None]:
    for index in todo:
        try:
            result = function(items[index])
        except Exception as error:
            raise raised(index, items, error) from error
        yield index, result


def _module(function: Callable) -> str:
    """Where a function stands."""
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__module__", None) or "builtins"
