"""Tasks over processes of this machine."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import forkserver, resource_tracker
from multiprocessing.synchronize import Event
from typing import Any

from .errors import SweepError, failed
from .executor import results

#: How many workers may die at one task before the sweep gives up.
ATTEMPTS = 3


def over_processes(
    function: Callable, items: Sequence[Any], todo: Sequence[int], count: int, module: str
) -> Generator[tuple[int, Any], None, None]:
    """Results as they come. No more tasks are handed out than there are workers, so a death is felt by few.

    A task that was running when a worker died runs again on its own, so the next death has one suspect. ``module`` is
    where the function stands: it is loaded once, not once a worker.
    """
    waiting, suspects = deque(todo), deque[int]()
    deaths: Counter[int] = Counter()
    while waiting or suspects:
        alone = bool(suspects)
        queue, size = (suspects, 1) if alone else (waiting, count)
        running: dict[Future, int] = {}
        with _pool(size, module) as (pool, started):
            try:
                yield from results(pool, function, items, queue, running, ahead=size)
            except BrokenProcessPool:
                if not started.is_set():
                    raise SweepError(
                        "worker processes end before they begin: a script has its calls under "
                        "if __name__ == '__main__':, since they import it; or workers=1"
                    ) from None
                deaths.update(running.values())
                for index in running.values():
                    if alone and deaths[index] >= ATTEMPTS:
                        problem = f"killed its worker process {deaths[index]} times"
                        raise failed(index, items, problem) from None
                suspects.extend(sorted(running.values()))


@contextlib.contextmanager
def _pool(count: int, module: str) -> Iterator[tuple[ProcessPoolExecutor, Event]]:
    """Worker processes, and whether any has begun; an error or an interruption ends them at once."""
    method = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
    context = multiprocessing.get_context(method)
    try:
        if method == "forkserver":
            context.set_forkserver_preload([module])
            _start_forkserver()
        started = context.Event()
        pool = _Pool(count, mp_context=context, initializer=_start_worker, initargs=(started,))
    except OSError as error:  # their locks are shared memory
        raise SweepError(f"worker processes cannot begin, /dev/shm: {error.strerror}; or workers=1") from None
    try:
        with _importable_script():
            yield pool, started
    except BaseException:
        for process in list((getattr(pool, "_processes", None) or {}).values()):
            process.kill()
        pool.shutdown(wait=True, cancel_futures=True)
        raise
    pool.shutdown(wait=True)


class _Pool(ProcessPoolExecutor):
    """A pool that is never interrupted between a process and the note of it.

    A process that nobody had noted would not be killed with the others, and complain of what went with this one.
    """

    def submit(self, *task: Any, **more: Any) -> Future:
        with _interrupted_later():
            return super().submit(*task, **more)


@contextlib.contextmanager
def _interrupted_later() -> Iterator[None]:
    """Put off an interruption to the end of the block."""
    usual = signal.getsignal(signal.SIGINT) if threading.current_thread() is threading.main_thread() else None
    if not callable(usual):  # it is ignored, or handled elsewhere
        yield
        return
    came: list[Any] = []
    signal.signal(signal.SIGINT, lambda *given: came.append(given))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if came:
            usual(*came[0])


def _start_forkserver() -> None:
    """Begin the process that forks the workers; it and they leave interruptions to this one, from their first moment.

    A terminal interrupts all processes at once, and one that is only just importing would say so.
    """
    resource_tracker.ensure_running()  # it would let interruptions through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _importable_script() -> Iterator[None]:
    """Workers import the script that started them; one from standard input is none that they could find."""
    script = sys.modules["__main__"]
    name = getattr(script, "__file__", None)
    if name is None or os.path.exists(name):
        yield
        return
    del script.__file__
    try:
        yield
    finally:
        script.__file__ = name


def _start_worker(started: Event) -> None:
    """Leave interruptions to the parent process, and end with it."""
    started.set()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:

        def end_with_parent() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()
