"""Numbers that a measurement is asked with and that must be greater than 0."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import require


def check_positive(**given: Any) -> None:
    """ValueError, with its name, for the first of ``given`` that is not a finite number greater than 0."""
    for name, value in given.items():
        number = np.asarray(value)
        rule = f"{name} = {value!r}: must be a finite number greater than 0"
        require(not number.ndim and number.dtype.kind in "iuf" and 0.0 < number < np.inf, rule)
