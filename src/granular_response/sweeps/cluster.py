"""Tasks over a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import os
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError, Future
from typing import Any

from ..machine import floating_point
from .errors import SweepError, failed
from .executor import results


def over_dask(
    function: Callable, items: Sequence[Any], todo: Sequence[int], address: str
) -> Generator[tuple[int, Any], None, None]:
    """Results as they come. The scheduler itself runs again what a dead worker was at."""
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise SweepError(
            f"a Dask scheduler is asked for ({address}), but the package distributed is not installed: "
            "pip install 'granular-response[dask]'"
        ) from None
    try:
        client = Client(address, timeout=10, set_as_default=False)
    except (AssertionError, OSError, TimeoutError, ValueError) as error:  # the first: its thread had no turn in 10 s
        raise SweepError(f"no Dask scheduler answers at {address}: {error}") from None
    with _quiet(), client:
        _compare_settings(client)
        executor = client.get_executor(pure=False)
        waiting, running = deque(todo), dict[Future, int]()

        def look_for_workers() -> None:
            with contextlib.suppress(OSError, TimeoutError):  # then the tasks will say that the scheduler is lost
                if not client.nthreads():
                    warnings.warn(f"the Dask scheduler at {address} has no workers: waiting for one", stacklevel=2)

        try:
            yield from results(executor, function, items, waiting, running, ahead=len(items), idle=look_for_workers)
        except KilledWorker as error:
            index = next(index for future, index in running.items() if future.done() and future.exception() is error)
            raise failed(index, items, "killed its worker process several times") from None
        except (CancelledError, OSError):
            raise SweepError(
                f"the Dask scheduler at {address} was lost, with {len(waiting) + len(running)} of {len(items)} tasks "
                "to do"
            ) from None
        finally:
            executor.shutdown(wait=False)


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
