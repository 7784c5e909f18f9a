"""Of processes that want the same piece of work, one does it, and the others wait until it is done.

Workers of a sweep start together and ask for the same kernels; each of them would compile all by itself. A turn is a
lock on one byte of a file, so it ends with the process that has it, whatever becomes of it, and a forked one has none
of its parent's. Two names may share a byte: then one waits for the other in vain, no longer than ``LONGEST_WAIT``.
"""

from __future__ import annotations

import fcntl
import os
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

#: After this time a process does what it waits for itself, in seconds: longer than any kernel takes to compile.
LONGEST_WAIT = 120.0
#: Time between two attempts, in seconds.
POLL = 0.02


class Turns:
    """Turns at ``path``, a file that is made when it is first asked for; without locks in its folder nobody waits."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._descriptor: int | None = None

    def take(self, name: str) -> bool:
        """Wait for the turn at ``name``; whether it came."""
        end = time.monotonic() + LONGEST_WAIT
        while True:
            try:
                self._lock(fcntl.LOCK_EX | fcntl.LOCK_NB, name)
            except BlockingIOError:
                if time.monotonic() > end:
                    return False
                time.sleep(POLL)
            except OSError:
                return False
            else:
                return True

    def give_back(self, name: str) -> None:
        """End the turn at ``name``."""
        self._lock(fcntl.LOCK_UN, name)

    @contextmanager
    def taken(self, name: str) -> Iterator[None]:
        """The block has the turn at ``name``, or does without it."""
        mine = self.take(name)
        try:
            yield
        finally:
            if mine:
                self.give_back(name)

    def _lock(self, what: int, name: str) -> None:
        if self._descriptor is None:
            self._descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        fcntl.lockf(self._descriptor, what, 1, zlib.crc32(name.encode()) >> 1)
