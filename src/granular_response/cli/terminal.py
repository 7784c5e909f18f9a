"""Progress on a terminal: nothing for the first two seconds, nothing at all where nobody looks."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn


class TerminalProgress:
    """A line with bar, elapsed time and time left on standard error: ``progress(done, total, what)``.

    Each new ``what`` starts over. Silent unless standard error is a terminal, and for ``patience`` seconds.
    """

    def __init__(self, console: Console | None = None, patience: float = 2.0) -> None:
        self._console = console or Console(stderr=True)
        self._patience = patience
        self._started = time.monotonic()
        self._bars: Progress | None = None
        self._task: TaskID | None = None
        self._what: str | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bars is not None:
            self._bars.stop()
            self._bars = None

    def __call__(self, done: float, total: float, what: str = "") -> None:
        if not self._console.is_terminal or time.monotonic() - self._started < self._patience:
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
