"""What is said where kernels have to be compiled first: a line in the log, and a stage of the progress."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from numba.core import event

LOG = logging.getLogger("granular_response")
TEXT = "compiling kernels, which takes up to a minute and is kept for the next time"
#: The stage of a progress in which nothing else goes on.
STAGE = "compiling (first run only)"


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
) -> AbstractContextManager[Any]:
    """Within it, the first compilation is logged and told to ``say``, and each is the stage of a ``progress``."""
    listener: AbstractContextManager[Any] = event.install_listener("numba:compile", _Once(progress, say))
    return listener
