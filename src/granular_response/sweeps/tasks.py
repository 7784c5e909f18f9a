"""One map over independent tasks: in this process, in processes of this machine, or over any executor.

An executor is a ``concurrent.futures.Executor``: Dask, MPI and loky have one. What goes to a worker and what comes back
are bytes, made and read here. So an executor never meets a value that cannot be sent: an exception or a result of any
kind ends in an error of its task. Functions of a notebook cell and lambdas go by their code, others by their name
(cloudpickle). Warnings come back too, and are said once for all workers.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import multiprocessing
import os
import pickle
import queue
import reprlib
import secrets
import signal
import sys
import tempfile
import threading
import traceback
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import forkserver, resource_tracker
from pathlib import Path
from typing import Any, SupportsIndex, TypeVar

import cloudpickle

from ..machine import floating_point, threads
from .errors import SweepError, failed, interrupted, raised
from .memory import MISSING, Memory
from .resources import KEPT, Resources, current, using
from .resources import Progress as Progress

LOG = logging.getLogger("granular_response")

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Exit code of a worker process that imports a script whose calls are not under its guard.
_UNGUARDED = 78
_NOT_BEGUN = "worker processes end before they begin"
_GUARD = "a script has its calls under if __name__ == '__main__':, since they import it; or workers=1"
#: Seconds after which an interruption is noticed.
_LOOK = 0.1
#: What was said already, as the module ``warnings`` keeps it.
_SAID: dict[Any, Any] = {}


class WorkerError(RuntimeError):
    """An exception that cannot leave its worker; its text is the traceback."""


def map_tasks(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    parts: Sequence[str] = (),
    what: str = "tasks",
) -> list[Result]:
    """Results of ``function`` for all items, in the order of the items and the same wherever they are computed.

    ``function`` is one of a module or a notebook, or a lambda, and draws random numbers only from seeds in its item. A
    script that calls ``map_tasks`` has its own calls under ``if __name__ == "__main__":``, since workers import it.

    Parameters
    ----------
    function, items : the task and its arguments.
    workers : number of local processes; this process if 1. If None, that of the :mod:`.resources` in use, else all
        cores. A task whose process died runs once more on its own.
    executor : a ``concurrent.futures.Executor`` to run the tasks in place of local processes: ``client.get_executor()``
        of Dask, ``mpi4py.futures.MPIPoolExecutor()``, loky's. It is not shut down. Its workers need the same packages,
        and run whatever reaches them, so they belong on a network of your own.
    progress : called as ``progress(done, total, what)`` at the start and after each task; if None, that of the
        resources. Where a checkpoint had results, it is called first with ``what`` "kept".
    checkpoint : folder in which the result of each finished task is kept until the caller removes it; a later call
        takes it from there. **It must be a folder of your own**: kept results are pickles, which run code as they are
        read. Files of another owner and files that fail their checksum are computed again. A result is taken if
        function, item, this package, the installed numba, numpy, scipy and xarray, and every module of your own that
        the function's module imports, directly or not, are the same; so are files that a scene (mappings and the name
        of a scene file too) or a ``Path`` in the item names. What else the function depends on is not known: data
        files that it opens by itself, modules that it finds by a name made at run time, other installed packages,
        environment variables, and a module that changed after it was imported. Of a lambda or a function of a notebook
        nothing is kept. If None, the folder of the resources in use; nothing is kept if there is none either.
    parts : the sources that the results depend on, as :func:`.keys.sources` takes them; all if none is named.
    what : what the tasks are, for the progress line.

    Raises SweepError for a set of items, which has no order; if a task raises or its worker dies (the message names its
    item), and if something cannot be sent to a worker or back. KeyboardInterrupt says how much was done.

    Examples
    --------
    >>> gr.map_tasks(abs, [-1, 2], workers=1)
    [1, 2]
    """
    if getattr(multiprocessing.current_process(), "_inheriting", False):  # a worker that imports an unguarded script
        os._exit(_UNGUARDED)
    given = current()
    if workers is not None and not (isinstance(workers, SupportsIndex) and workers.__index__() >= 1):
        raise SweepError(f"workers = {workers!r}: must be a whole number, 1 or more")
    if executor is not None:
        _check_executor(executor, workers)
    if isinstance(items, (set, frozenset)):
        raise SweepError(f"items = {reprlib.repr(items)}: must be a list, a set has no order for the results to be in")
    items = list(items)
    executor = given.executor if executor is None and workers is None else executor
    workers, progress = given.workers if workers is None else workers, progress or given.progress
    folder = checkpoint or given.checkpoint
    memory = Memory(folder, parts, given.packages) if folder and items else None
    done = 0

    def finish(index: int, result: Any) -> None:
        nonlocal done
        results[index] = result
        if memory:
            memory.save_result(names[index], result, function, items[index])
        done += 1
        if progress:
            progress(done, len(items), what)

    try:
        names = [memory.name(function, item) if memory else None for item in items]
        results: list[Any] = [memory.load(name) if memory else MISSING for name in names]
        todo = [index for index, result in enumerate(results) if result is MISSING]
        done = len(items) - len(todo)
        if done:
            LOG.info("%d of %d %s kept", done, len(items), what)
        if progress:
            if done:
                progress(done, len(items), KEPT)
            progress(done, len(items), what)
        task = functools.partial(_alone, function, given.rest_states)
        count = min(workers or threads.cores(), len(todo))
        if executor is not None:
            with _interruptions() as look:
                _submitted(executor, task, items, deque(todo), {}, len(todo), look, finish)
        elif count <= 1 and workers in (1, None):
            _here(task, items, todo, finish)
        else:
            _over_processes(task, items, todo, count, _module(function), finish)
    except KeyboardInterrupt:
        raise interrupted(f"{done} of {len(items)} {what} are {f'kept in {folder}' if memory else 'done'}") from None
    return results


def _check_executor(executor: Any, workers: int | None) -> None:
    if not isinstance(executor, Executor):
        cure = "; of a Dask client it is client.get_executor()" if hasattr(executor, "get_executor") else ""
        raise SweepError(f"executor = {reprlib.repr(executor)}: must be a concurrent.futures.Executor{cure}")
    if workers is not None:
        raise SweepError(f"workers = {workers}: must be left out with an executor, which has its own")


def _alone(function: Callable, rest_states: Path | None, item: Any) -> Any:
    """Call a function where it may use ``rest_states`` and nothing else of the resources."""
    with using(**vars(Resources(rest_states=rest_states))):
        return function(item)


def _module(function: Callable) -> str:
    """Where a function stands."""
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__module__", None) or "builtins"


def _here(task: Callable, items: Sequence[Any], todo: Sequence[int], finish: Callable[[int, Any], None]) -> None:
    for index in todo:
        try:
            result = task(items[index])
        except Exception as error:
            raise raised(index, items, error) from error
        finish(index, result)


def _submitted(
    executor: Executor,
    task: Callable,
    items: Sequence[Any],
    waiting: deque[int],
    running: dict[Future, int],
    ahead: int,
    look: Callable[[], None],
    finish: Callable[[int, Any], None],
    own: type[Exception] | tuple[()] = (),
) -> None:
    """Run the tasks ``waiting``, at most ``ahead`` of them at once, and ``finish`` each as it comes.

    What is handed out goes from ``waiting`` to ``running``, and leaves that with its result. Raises SweepError for a
    task that fails or is lost, but what is of the class ``own`` as it comes.
    """
    sent = _packed(waiting[0], items, task)
    token = secrets.token_hex(8)
    done: queue.SimpleQueue[Future] = queue.SimpleQueue()
    try:
        while waiting or running:
            while waiting and len(running) < ahead:
                packed = _packed(waiting[0], items, items[waiting[0]])
                try:
                    future = executor.submit(_run, sent, packed, os.getpid(), token)
                except own:
                    raise
                except (BrokenExecutor, EOFError, OSError, RuntimeError) as error:
                    said = f"{type(error).__name__}: {error}"
                    if own:  # the process that forks the others was killed
                        raise BrokenProcessPool(f"{_NOT_BEGUN} ({said}): they were killed; or {_GUARD}") from None
                    raise SweepError(f"{type(executor).__name__} takes no tasks: {said}") from None
                running[future] = waiting.popleft()
                future.add_done_callback(done.put)
            look()
            try:
                future = done.get(timeout=_LOOK)
            except queue.Empty:
                continue
            outcome = _outcome(future, running[future], items, own)
            index = running.pop(future)
            del future  # nobody holds what came of it any longer
            finish(index, outcome)
    finally:
        for future in running:
            future.cancel()


def _packed(index: int, items: Sequence[Any], value: Any) -> bytes:
    """The bytes of an item, or of the function of a sweep; raises SweepError if it cannot be sent."""
    try:
        return cloudpickle.dumps(value)
    except Exception as error:  # whatever its own methods raise
        raise failed(index, items, f"cannot be sent to a worker: {type(error).__name__}: {error}") from None


def _settings() -> dict[str, str | None]:
    return {name: os.environ.get(name) for name in floating_point.variables()}


def _run(function: bytes, item: bytes, parent: int, token: str) -> bytes:
    """In a worker: call a packed function with a packed item.

    Dask takes calls with the same arguments for one, and would cancel those of a sweep with those of the one before;
    ``token`` is the sweep's own.
    """
    # a thread of the parent process says its warnings itself
    heard_here = warnings.catch_warnings(record=True) if os.getpid() != parent else contextlib.nullcontext()
    with heard_here as heard, threads.using(1):  # whatever the process had that was forked
        said, body = _called(function, item)
    lines = [(str(one.message), one.category, one.filename, one.lineno) for one in heard or ()]
    return cloudpickle.dumps((said, body, lines, _settings()))


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


@functools.lru_cache(maxsize=4)
def _loaded(function: bytes) -> Callable[[Any], Any]:
    return pickle.loads(function)


def _outcome(future: Future, index: int, items: Sequence[Any], own: type[Exception] | tuple[()]) -> Any:
    """The result of a task; raises SweepError if it raised, was lost, or returned what cannot be read here."""
    try:
        said, body, lines, settings = pickle.loads(future.result())
    except own:
        raise
    except BaseException as error:  # Dask's own, and a cancellation, which is none of Exception
        raise raised(index, items, error, f"{type(error).__name__}: {error}", "was lost") from error
    for text, category, file, line in lines:
        warnings.warn_explicit(text, category, file, line, registry=_SAID)
    if settings != _settings():
        where = floating_point.__name__
        text = f"workers are not set to round as this process does, so last digits may differ: see {where}"
        warnings.warn_explicit(text, UserWarning, __file__, 1, registry=_SAID)
    try:
        value = pickle.loads(body)
    except Exception as error:
        said = said or f"its result cannot be read: {type(error).__name__}: {error}"
        raise raised(index, items, error, said) from error
    if said is None:
        return value
    raise raised(index, items, value, said) from value


def _over_processes(
    task: Callable,
    items: Sequence[Any],
    todo: Sequence[int],
    count: int,
    module: str,
    finish: Callable[[int, Any], None],
) -> None:
    """Tasks in local processes. No more are handed out than there are workers, so a death is felt by few.

    Those that were running when a worker died run again, each alone, so the one that dies then is known.
    """
    waiting, suspects = deque(todo), deque[int]()
    while waiting or suspects:
        alone = bool(suspects)
        chosen, size = (deque([suspects.popleft()]), 1) if alone else (waiting, count)
        running: dict[Future, int] = {}
        with _pool(size, module) as (pool, look):
            try:
                _submitted(pool, task, items, chosen, running, size, look, finish, BrokenProcessPool)
            except BrokenProcessPool as broken:
                processes = list((getattr(pool, "_processes", None) or {}).values())
                pool.shutdown(wait=True)
                if any(one.exitcode == _UNGUARDED for one in processes):
                    raise SweepError(f"{_NOT_BEGUN}: {_GUARD}") from None
                if alone and str(broken).startswith(_NOT_BEGUN):
                    raise SweepError(str(broken)) from None
                if alone:
                    index = next(iter((*running.values(), *chosen)))
                    raise failed(index, items, "killed its worker process twice") from None
                suspects.extend(sorted(running.values()) or [chosen.popleft()])


@contextlib.contextmanager
def _pool(count: int, module: str) -> Iterator[tuple[ProcessPoolExecutor, Callable[[], None]]]:
    """Worker processes, and what raises an interruption; an error or an interruption ends them at once."""
    context = multiprocessing.get_context("forkserver")  # of every Unix
    try:
        context.set_forkserver_preload([module])  # loaded once, not once a worker
        _start_forkserver()
        pool = ProcessPoolExecutor(count, mp_context=context, initializer=_start_worker)
    except OSError as error:  # their locks are shared memory, their socket has a name of 107 bytes at most
        places = f"/dev/shm or TMPDIR ({tempfile.gettempdir()})"
        raise SweepError(f"worker processes cannot begin, {places}: {error.strerror or error}; or workers=1") from None
    try:
        with _importable_script(), _interruptions() as look:
            yield pool, look
    except BaseException:
        for process in list((getattr(pool, "_processes", None) or {}).values()):
            process.kill()
        pool.shutdown(wait=True, cancel_futures=True)
        raise
    pool.shutdown(wait=True)


@contextlib.contextmanager
def _interruptions() -> Iterator[Callable[[], None]]:
    """Interruptions wait for the call of what this gives: a process that nobody had noted yet would outlive them."""
    usual = signal.getsignal(signal.SIGINT) if threading.current_thread() is threading.main_thread() else None
    if not callable(usual):  # it is ignored, or handled elsewhere
        yield lambda: None
        return
    came: list[Any] = []

    def look() -> None:
        if came:
            usual(*came.pop())

    signal.signal(signal.SIGINT, lambda *given: came.append(given))
    try:
        yield look
    finally:
        signal.signal(signal.SIGINT, usual)
        look()


def _start_forkserver() -> None:
    """Begin the process that forks the workers; it and they leave interruptions to this one, from their first moment.

    A terminal interrupts all processes at once, and one that is only just importing would say so.
    """
    with _import_path():
        resource_tracker.ensure_running()  # it would let interruptions through again
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            forkserver.ensure_running()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _import_path() -> Iterator[None]:
    """Processes that begin here import nothing from the current folder, a ``numpy.py``, unless this one does too."""
    name, given = "PYTHONSAFEPATH", os.environ.get("PYTHONSAFEPATH")
    if given or {"", os.getcwd()} & set(sys.path):
        yield
        return
    os.environ[name] = "1"
    try:
        yield
    finally:
        os.environ.pop(name) if given is None else os.environ.update({name: given})


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


def _start_worker() -> None:
    """End with the parent process, and leave interruptions to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:

        def end_with_parent() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()
