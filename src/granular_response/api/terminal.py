"""What is said of a computation: progress, silent at first and where nobody looks, and that kernels are compiled."""

from __future__ import annotations

import contextlib
import logging
import os
import shutil
import time
from collections.abc import Callable, Iterator
from typing import Any, Self

from numba.core import event
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from ..sweeps.resources import KEPT

LOG = logging.getLogger("granular_response")
TEXT = "compiling kernels, which takes up to a minute and is kept for the next time"
#: The stage of a progress in which nothing else goes on.
STAGE = "compiling (first run only)"


def columns() -> int | None:
    """Width of a terminal for ``rich``; None: as it finds out. Where ``COLUMNS`` is 0 it would show nothing."""
    return None if os.environ.get("COLUMNS", "1").strip("0 ") else shutil.get_terminal_size().columns


@contextlib.contextmanager
def shown(progress: Callable[..., Any] | bool) -> Iterator[Callable[..., Any] | None]:
    """What is called with the progress: a bar, a function of the user's, or nothing."""
    with TerminalProgress() if progress is True else contextlib.nullcontext(progress or None) as report:
        yield report


class TerminalProgress:
    """A line with bar, elapsed time and time left on standard error: ``progress(done, total, what)``.

    Each new ``what`` starts over. Silent for ``patience`` seconds. A notebook gets a line of text; a log file, and a
    terminal that moves no cursor (``TERM=dumb``), a line after each ``pause`` seconds. What a checkpoint has is said at
    once.
    """

    def __init__(self, console: Console | None = None, patience: float = 2.0, pause: float = 60.0) -> None:
        self._console = console or Console(stderr=True, width=columns())
        self._patience, self._pause = patience, pause
        self._started = self._logged = time.monotonic()
        self._bars: Progress | None = None
        self._task: TaskID | None = None
        self._what: str | None = None
        self._told: float | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars is not None:
            self._bars.stop()
            self._bars = None
        if self._told is not None:
            self._console.file.write("\n")
            self._told = None

    def __call__(self, done: float, total: float, what: str = "") -> None:
        now = time.monotonic()
        if what == KEPT:
            self._console.file.write(f"{done:.4g} of {total:.4g} kept\n")
            self._console.file.flush()
            return
        if now - self._started < self._patience:
            return
        if self._console.is_jupyter:
            if self._told is None or now - self._told > 0.5 or done == total:
                elapsed = f"{now - self._started:.0f} s "
                self._console.file.write(f"\r{what or 'working'}: {done:.4g} of {total:.4g}, {elapsed}")
                self._told = now
            return
        if not (self._console.is_interactive and self._console.file.isatty()):  # colours can be forced upon a file
            if now - self._logged >= self._pause:
                self._logged, elapsed = now, f"{now - self._started:.0f} s"
                self._console.file.write(f"{what or 'working'}: {done:.4g} of {total:.4g}, {elapsed}\n")
                self._console.file.flush()
            return
        if self._bars is None:
            self._bars = Progress(
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.percentage:>3.0f} %"),
                TimeElapsedColumn(),
                TextColumn("left"),
                TimeRemainingColumn(),
                console=self._console,
                transient=True,
            )
            self._bars.start()
        if self._task is None or what != self._what:
            if self._task is not None:
                self._bars.remove_task(self._task)
            self._task = self._bars.add_task(what or "working", total=total)
            self._what = what
        self._bars.update(self._task, completed=done, total=total)


class _Once(event.Listener):
    def __init__(self, progress: Callable[[float, float, str], Any] | None, say: Callable[[str], None] | None) -> None:
        self._said, self._progress, self._say = False, progress, say

    def on_start(self, _: Any) -> None:
        if not self._said:
            self._said = True
            LOG.info(TEXT)
            if self._say is not None:
                self._say(TEXT)
        if self._progress is not None:  # of every function: a bar is silent at first
            self._progress(0.0, 1.0, STAGE)

    def on_end(self, _: Any) -> None:
        pass


def logged(
    progress: Callable[[float, float, str], Any] | None = None, say: Callable[[str], None] | None = None
) -> contextlib.AbstractContextManager[Any]:
    """Within it, the first compilation is logged and told to ``say``, and each is the stage of a ``progress``."""
    listener: contextlib.AbstractContextManager[Any] = event.install_listener("numba:compile", _Once(progress, say))
    return listener
