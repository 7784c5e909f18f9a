"""Which of the stored states of a result is meant."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import GranularError


class StateIndexError(GranularError, IndexError):
    """A state that a result does not have. The message is one line."""


def state_index(state: Any, count: int) -> int:
    """The index, from 0 on, of a ``state`` of ``count``: 0 the initial equilibrium, then those under load, -1 the last.

    Raises TypeError for what is no integer, StateIndexError for a state that does not exist.
    """
    if isinstance(state, bool) or not isinstance(state, (int, np.integer)):
        raise TypeError(f"state = {state!r}: must be an integer, 0 for the initial equilibrium")
    if not -count <= state < count:
        raise StateIndexError(f"state = {state}: must be from {-count} to {count - 1}, there are {count} states")
    return int(state) % count
