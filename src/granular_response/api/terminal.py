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
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from ..sweeps.resources import KEPT

LOG = logging.getLogger("granular_response")
TEXT = "compiling kernels, which takes up to a minute and is kept for the next time"
#: The stage of a progress in which nothing else goes on.
STAGE = "compiling (first run only)"
#: Seconds after which a progress is shown, and between two lines of a log file.
PATIENCE, PAUSE = 2.0, 60.0


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

    Each new ``what`` starts over. Silent for :data:`PATIENCE`. A notebook gets a line of text; a log file, and a
    terminal that moves no cursor (``TERM=dumb``), a line after each :data:`PAUSE`. What a checkpoint has is said at
    once.
    """

    def __init__(self, console: Console | None = None) -> None:
        self._console = console or Console(stderr=True, width=columns())
        self._started = self._told = time.monotonic()
        self._bars: Progress | None = None
        self._what: str | None = None
        self._in_line = False  #: of a notebook, which has no end yet

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars is not None:
            self._bars.stop()
        if self._in_line:
            self._console.file.write("\n")

    def __call__(self, done: float, total: float, what: str = "") -> None:
        now, file = time.monotonic(), self._console.file
        said = f"{done:.4g} of {total:.4g}"
        if what == KEPT:
            file.write(f"{said} kept\n")
            file.flush()
            return
        if now - self._started < PATIENCE:
            return
        line = f"{what or 'working'}: {said}, {now - self._started:.0f} s"
        if self._console.is_jupyter:
            if not self._in_line or now - self._told > 0.5 or done == total:
                self._told, self._in_line = now, True
                file.write(f"\r{line} ")
            return
        if not (self._console.is_interactive and file.isatty()):  # colours can be forced upon a file
            if now - self._told >= PAUSE:
                self._told = now
                file.write(f"{line}\n")
                file.flush()
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
        if what != self._what:
            for task in self._bars.task_ids:
                self._bars.remove_task(task)
            self._bars.add_task(what or "working", total=total)
            self._what = what
        self._bars.update(self._bars.task_ids[0], completed=done, total=total)


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
