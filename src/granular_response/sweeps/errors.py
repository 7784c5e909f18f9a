"""What goes wrong with a sweep, in one line that names the task."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import Any

from ..errors import GranularError


class SweepError(GranularError, RuntimeError):
    """A sweep that cannot go on. One line; ``__cause__`` is the exception of the task, if any."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


def failed(index: int, items: Sequence[Any], problem: str) -> SweepError:
    """The error of one task."""
    return SweepError(f"task {index + 1} of {len(items)} ({reprlib.repr(items[index])}) {problem}")


def raised(index: int, items: Sequence[Any], error: BaseException, said: str | None = None) -> SweepError:
    """The error of a task that raised; ``said`` is what the exception says, if not its type and text."""
    failure = failed(index, items, f"failed: {said or f'{type(error).__name__}: {error}'}")
    failure.__cause__ = error
    return failure
