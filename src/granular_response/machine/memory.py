"""How much memory this process may still take."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from pathlib import Path


def available() -> int | None:
    """Bytes that are free on the machine, or less where the process is limited; None where nobody says."""
    return min(_limits(), default=None)


def _limits() -> Iterator[int]:
    for line in _read("/proc/meminfo").splitlines():
        if line.startswith("MemAvailable:"):
            yield 1024 * int(line.split()[1])
    group, used = _read("/sys/fs/cgroup/memory.max").strip(), _read("/sys/fs/cgroup/memory.current").strip()
    if group.isdecimal() and used.isdecimal():
        yield max(int(group) - int(used), 0)
    space, _ = resource.getrlimit(resource.RLIMIT_AS)
    pages = _read("/proc/self/statm").split()
    if space != resource.RLIM_INFINITY and pages:
        yield max(space - int(pages[0]) * os.sysconf("SC_PAGE_SIZE"), 0)


def _read(path: str) -> str:
    try:
        return Path(path).read_text()
    except OSError:
        return ""
