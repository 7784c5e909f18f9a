"""Tasks over a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from typing import Any

from ..machine import floating_point, without_dask
from .errors import SweepError, failed, raised
from .worker import packed, run, unpacked

#: Seconds without a result after which it is looked whether there are workers at all.
PATIENCE = 10.0

#: How often a client is started that a busy machine does not let start.
STARTS = 3


def over_dask(
    function: Callable, items: Sequence[Any], todo: Sequence[int], address: str
) -> Generator[tuple[int, Any], None, None]:
    """Results as they come. The scheduler itself runs again what a dead worker was at."""
    without_dask.show()
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise SweepError(
            f"a Dask scheduler is asked for ({address}), but the package distributed is not installed: "
            "pip install 'granular-response[dask]'"
        ) from None
    for left in reversed(range(STARTS)):
        try:
            client = Client(address, timeout=10, set_as_default=False)
            break
        except (OSError, TimeoutError, ValueError) as error:
            raise SweepError(f"no Dask scheduler answers at {address}: {error}") from None
        except AssertionError:  # its thread had no turn within ten seconds
            if not left:
                raise SweepError("this machine is too busy to start a Dask client") from None
    with _quiet(), client:
        sent = packed(todo[0], items, function)
        finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        futures = {}
        compared = _compare_settings(client)
        for index in todo:
            future = client.submit(run, sent, packed(index, items, items[index]), pure=False)
            futures[future] = index
            future.add_done_callback(finished.put)
        try:
            while futures:
                future = _next(finished, client, address)
                index = futures.pop(future)
                try:
                    outcome = future.result()  # waits once more if it was lost with its worker
                except KilledWorker:
                    raise failed(index, items, "killed its worker process several times") from None
                except Exception as error:
                    if isinstance(error, CancelledError) or client.status != "running":
                        raise SweepError(
                            f"the Dask scheduler at {address} was lost, with {len(futures) + 1} of {len(items)} tasks "
                            "to do"
                        ) from None
                    raise raised(index, items, error) from error
                future.release()  # what the cluster still had to hold it would compute again after a death
                compared = compared or _compare_settings(client)
                yield index, unpacked(index, items, outcome)
        finally:
            client.cancel(list(futures))


def _next(finished: queue.SimpleQueue[Any], client: Any, address: str) -> Any:
    """The next task that has finished; says if there is no worker to finish one."""
    while True:
        with contextlib.suppress(queue.Empty):
            return finished.get(timeout=PATIENCE)
        with contextlib.suppress(OSError, TimeoutError):  # then the tasks will say that the scheduler is lost
            if not client.nthreads():
                warnings.warn(f"the Dask scheduler at {address} has no workers: waiting for one", stacklevel=2)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without the tracebacks that a client logs when it loses its scheduler: there is an error that says so."""
    logger = logging.getLogger("distributed.client")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def _compare_settings(client: Any) -> bool:
    """Warn where workers round otherwise than this process; whether there were any."""
    here = _settings()
    there = client.run(_settings, on_error="ignore")
    different = sorted(address for address, settings in there.items() if settings != here)
    if different:
        warnings.warn(
            f"{len(different)} of {len(there)} Dask workers, the first of them {different[0]}, are not set to round as "
            f"this process does, so last digits may differ: see {floating_point.__name__}",
            stacklevel=2,
        )
    return bool(there)


def _settings() -> dict[str, str | None]:
    return {name: os.environ.get(name) for name in floating_point.variables()}
