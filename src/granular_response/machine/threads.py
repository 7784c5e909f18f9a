"""How many threads a computation takes: one, unless more are asked for around it.

The factorisations of large packings use them. Results have the same bits for any number. Processes of a sweep are one
for each core already, and keep to one thread each.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextvars import ContextVar
from operator import index
from typing import Any, SupportsIndex

_COUNT: ContextVar[int] = ContextVar("threads", default=1)


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextlib.contextmanager
def using(count: int) -> Iterator[None]:
    """Take ``count`` threads in this block; raises ValueError for less than one.

    Examples
    --------
    >>> with gr.threads(2):
    ...     result = gr.solve(gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9)))
    """
    if not (isinstance(count, SupportsIndex) and index(count) >= 1):
        raise ValueError(f"threads = {count!r}: must be a whole number, 1 or more")
    token = _COUNT.set(count)
    try:
        yield
    finally:
        _COUNT.reset(token)


#: Calls a function on items, on whatever threads there are; results are in the order of the items.
Map = Callable[[Callable[[Any], Any], Iterable[Any]], list[Any]]


@contextlib.contextmanager
def mapping(wanted: bool = True) -> Iterator[Map]:
    """A map on the threads that were asked for, or on this one where no more are ``wanted``.

    They end with the block: a process that forks later has none.
    """
    count = _COUNT.get()
    if count == 1 or not wanted:
        yield lambda function, items: list(map(function, items))
        return
    with ThreadPoolExecutor(count) as pool:
        yield lambda function, items: list(pool.map(function, items))
