"""Numbers that a measurement is asked with and that must be greater than 0."""

from __future__ import annotations

from typing import Any

import numpy as np


def check_positive(**given: Any) -> None:
    """ValueError, with its name, for the first of ``given`` that is not a finite number greater than 0."""
    for name, value in given.items():
        number = np.asarray(value)
        if number.ndim or number.dtype.kind not in "iuf" or not 0.0 < number < np.inf:
            raise ValueError(f"{name} = {value!r}: must be a finite number greater than 0")
