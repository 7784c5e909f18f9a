"""One map over independent tasks: in this process, over local processes, or over a Dask cluster.

``map_tasks(function, items)`` is ``[function(item) for item in items]`` with progress, with all cores, and
with what is finished kept: an interrupted run continues where it was, and a worker that dies costs only the
task it was at. The result does not depend on where the tasks ran.

A task is a module-level function (or a ``functools.partial`` of one) of one argument that can be pickled. It
draws random numbers only from seeds in its item. A script that calls ``map_tasks`` has its own calls under
``if __name__ == "__main__":``, since workers import it.
"""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import os
import reprlib
import signal
import threading
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

from ..machine import floating_point
from .digest import Indistinct, digest, sources
from .memory import MISSING, Memory, warn
from .resources import current, using

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Environment variable with the address of a running Dask scheduler, the one that Dask itself reads.
SCHEDULER_VARIABLE = "DASK_SCHEDULER_ADDRESS"

#: How many workers may die at one task before the sweep gives up.
ATTEMPTS = 3

Finished = Generator[tuple[int, Any], None, None]


class SweepError(RuntimeError):
    """A sweep that cannot go on. One line; ``__cause__`` is the exception of the task, if any."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class Progress(Protocol):
    """Anything that wants to know how far a computation is: ``progress(done, total, "load paths")``."""

    def __call__(self, done: float, total: float, what: str = "", /) -> None: ...


def map_tasks(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    what: str = "tasks",
) -> list[Result]:
    """Results of ``function`` for all items, in the order of the items.

    Parameters
    ----------
    function, items
        The task and its arguments.
    workers
        Number of local processes; all cores if None, this process if 1.
    scheduler
        Address of a Dask scheduler (``tcp://host:8786``). If None, the :mod:`.resources` in use and
        ``DASK_SCHEDULER_ADDRESS`` are asked.
    progress
        Called as ``progress(done, total, what)`` at the start and after each task.
    checkpoint
        Folder in which the result of each finished task is kept until the caller removes it. A later call
        finds it there if function, item and the sources of this package are the same (see :mod:`.digest`). If None,
        that of the resources in use; nothing is kept if there is none either.
    what
        What the tasks are, for the progress line.

    Raises
    ------
    SweepError
        If a task raises (the message names its item), if workers keep dying at one task, or if the cluster
        cannot be reached.
    """
    if workers is not None and workers < 1:
        raise SweepError(f"workers = {workers}: must be 1 or more")
    items = list(items)
    scheduler = scheduler or current().scheduler or os.environ.get(SCHEDULER_VARIABLE) or None
    folder = checkpoint or current().checkpoint
    kept = _Checkpoint(folder, function, items) if folder and items else None

    results: list[Any] = [kept.load(index) if kept else MISSING for index in range(len(items))]
    todo = [index for index, result in enumerate(results) if result is MISSING]
    done = len(items) - len(todo)
    if progress:
        progress(done, len(items), what)
    if not todo:
        return results
    count = min(workers or _cores(), len(todo))
    # the nodes of a cluster may not share the folder
    function = _Task(function, None if scheduler else current().rest_states)
    if scheduler:
        finished = _over_dask(function, items, todo, scheduler)
    elif count == 1 and workers in (1, None):
        finished = _here(function, items, todo)
    else:
        finished = _over_processes(function, items, todo, count)
    with contextlib.closing(finished):  # whatever goes wrong below ends the workers at once
        for index, result in finished:
            results[index] = result
            if kept:
                kept.save(index, items[index], result)
            done += 1
            if progress:
                progress(done, len(items), what)
    return results


@dataclass(frozen=True)
class _Task:
    """A function with what it may use where it runs."""

    function: Callable
    rest_states: Path | None

    def __call__(self, item: Any) -> Any:
        with using(scheduler=None, checkpoint=None, rest_states=self.rest_states):
            return self.function(item)


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _failed(index: int, items: Sequence[Any], problem: str) -> SweepError:
    return SweepError(f"task {index + 1} of {len(items)} ({reprlib.repr(items[index])}) {problem}")


def _raised(index: int, items: Sequence[Any], error: BaseException) -> SweepError:
    failure = _failed(index, items, f"failed: {type(error).__name__}: {error}")
    failure.__cause__ = error
    return failure


def _here(function: Callable, items: Sequence[Any], todo: Sequence[int]) -> Finished:
    for index in todo:
        try:
            result = function(items[index])
        except Exception as error:
            raise _raised(index, items, error) from error
        yield index, result


def _over_processes(function: Callable, items: Sequence[Any], todo: Sequence[int], count: int) -> Finished:
    """Results as they come. No more tasks are handed out than there are workers, so a death is felt by few.

    A task that was running when a worker died runs again on its own, so the next death has one suspect.
    """
    waiting = list(reversed(todo))
    suspects: list[int] = []
    deaths = dict.fromkeys(todo, 0)
    while waiting or suspects:
        alone = bool(suspects)
        queue, size = (suspects, 1) if alone else (waiting, count)
        running: dict[Future, int] = {}
        with _pool(size, function) as pool:
            try:
                while running or queue:
                    while queue and len(running) < size:
                        running[pool.submit(function, items[queue[-1]])] = queue[-1]
                        queue.pop()
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        index = running[future]
                        error = future.exception()
                        if isinstance(error, BrokenProcessPool):
                            raise error
                        del running[future]
                        if error is not None:
                            raise _raised(index, items, error) from error
                        yield index, future.result()
            except BrokenProcessPool:
                for index in running.values():
                    deaths[index] += 1
                    if alone and deaths[index] >= ATTEMPTS:
                        times = f"{deaths[index]} times"
                        raise _failed(index, items, f"killed its worker process {times}") from None
                    suspects.append(index)
                suspects.sort(reverse=True)


@contextlib.contextmanager
def _pool(count: int, function: Callable) -> Iterator[ProcessPoolExecutor]:
    """Worker processes; an error or an interruption ends them at once."""
    method = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
    context = multiprocessing.get_context(method)
    if method == "forkserver":  # heavy imports happen once, not once a worker
        context.set_forkserver_preload([_bare(function).__module__])
    pool = ProcessPoolExecutor(count, mp_context=context, initializer=_start_worker)
    try:
        yield pool
    except BaseException:
        for process in list((getattr(pool, "_processes", None) or {}).values()):
            process.kill()
        pool.shutdown(wait=True, cancel_futures=True)
        raise
    pool.shutdown(wait=True)


def _start_worker() -> None:
    """Leave interruptions to the parent process, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:

        def end_with_parent() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()


def _over_dask(function: Callable, items: Sequence[Any], todo: Sequence[int], address: str) -> Finished:
    """Results as they come. The scheduler itself runs again what a dead worker was at."""
    try:
        from distributed import Client, KilledWorker, as_completed
    except ImportError:
        raise SweepError(
            f"a Dask scheduler is asked for ({address}), but the package distributed is not installed: "
            "pip install 'granular-response[dask]'"
        ) from None
    try:
        client = Client(address, timeout=10, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise SweepError(f"no Dask scheduler answers at {address}: {' '.join(str(error).split())}") from None
    with client:
        _compare_settings(client)
        futures = {client.submit(function, items[index], pure=False): index for index in todo}
        try:
            for future in as_completed(list(futures), loop=client.loop):
                index = futures.pop(future)
                try:
                    result = future.result()  # waits once more if it was lost with its worker
                except KilledWorker:
                    raise _failed(index, items, "killed its worker process several times") from None
                except Exception as error:
                    raise _raised(index, items, error) from error
                future.release()  # what the cluster still had to hold it would compute again after a death
                yield index, result
        finally:
            client.cancel(list(futures))


def _compare_settings(client: Any) -> None:
    """Warn where workers round otherwise than this process."""
    here = _settings()
    there = client.run(_settings, on_error="ignore")
    different = sorted(address for address, settings in there.items() if settings != here)
    if different:
        warnings.warn(
            f"{len(different)} of {len(there)} Dask workers, the first of them {different[0]}, are not set to round as "
            f"this process does, so last digits may differ: see {floating_point.__name__}",
            stacklevel=2,
        )


def _settings() -> dict[str, str | None]:
    return {name: os.environ.get(name) for name in floating_point.variables()}


class _Checkpoint:
    """Finished results of one function in a folder; nothing is kept of what has no name of its own."""

    def __init__(self, folder: str | os.PathLike[str], function: Callable, items: Sequence[Any]) -> None:
        module = getattr(_bare(function), "__module__", None)
        self.memory = Memory(folder, sources(), (module,) if module else ())
        self.function = self._name(function)
        self.names = [self._name(self.function, item) if self.function else None for item in items]

    def _name(self, *values: Any) -> str | None:
        try:
            return digest(*values)
        except Indistinct as error:
            warn(f"{self.memory.folder}: {error}, so results are not kept")
            return None

    def load(self, index: int) -> Any:
        """The kept result of an item, or MISSING."""
        name = self.names[index]
        return MISSING if name is None else self.memory.load(name)

    def save(self, index: int, item: Any, result: Any) -> None:
        """Keep a result, unless what it was made from has changed meanwhile."""
        name = self.names[index]
        if name is not None and self._name(self.function, item) == name:
            self.memory.save(name, result)


def _bare(function: Callable) -> Callable:
    while isinstance(function, (functools.partial, _Task)):
        function = function.func if isinstance(function, functools.partial) else function.function
    return function
