"""One line in the log ``granular_response`` where kernels have to be compiled first."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from numba.core import event

LOG = logging.getLogger("granular_response")
TEXT = "compiling kernels, which takes up to a minute and is kept for the next time"


class _Once(event.Listener):
    def __init__(self, say: Callable[[str], None] | None) -> None:
        self._said, self._say = False, say

    def on_start(self, _: Any) -> None:
        if not self._said:
            self._said = True
            LOG.info(TEXT)
            if self._say is not None:
                self._say(TEXT)

    def on_end(self, _: Any) -> None:
        pass


def logged(say: Callable[[str], None] | None = None) -> AbstractContextManager[Any]:
    """Within it, the first compilation is logged, and told to ``say``."""
    listener: AbstractContextManager[Any] = event.install_listener("numba:compile", _Once(say))
    return listener
