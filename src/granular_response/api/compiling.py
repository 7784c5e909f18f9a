"""One line in the log ``granular_response`` where kernels have to be compiled first."""

from __future__ import annotations

import logging
from contextlib import AbstractContextManager
from typing import Any

from numba.core import event

LOG = logging.getLogger("granular_response")


class _Once(event.Listener):
    def __init__(self) -> None:
        self._said = False

    def on_start(self, _: Any) -> None:
        if not self._said:
            self._said = True
            LOG.info("compiling kernels, which takes up to a minute and is kept for the next time")

    def on_end(self, _: Any) -> None:
        pass


def logged() -> AbstractContextManager[Any]:
    """Within it, the first compilation is logged."""
    listener: AbstractContextManager[Any] = event.install_listener("numba:compile", _Once())
    return listener
