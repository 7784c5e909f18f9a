"""The base of all errors of this package, and the checks that raise them."""

from __future__ import annotations

from typing import Any


class GranularError(Exception):
    """Something that this package cannot do as asked, and why. Most messages are one line."""


class SolveError(GranularError):
    """No equilibrium was found for a well-formed scene, or none is there."""


class EquilibriumError(SolveError, RuntimeError):
    """No static equilibrium was found near the start."""


def require(met: object, said: str, error: type[Exception] = ValueError) -> None:
    """Raise ``error`` with the message ``said`` unless a condition is ``met``."""
    if not met:
        raise error(said)


def check_positive(error: type[Exception] = ValueError, /, **given: Any) -> None:
    """``error``, with its name, for the first of ``given`` that is not a finite number greater than 0."""
    import numpy as np  # here, so that nothing waits for it that only has errors

    for name, value in given.items():
        number = np.asarray(value)
        rule = f"{name} = {value!r}: must be a finite number greater than 0"
        require(not number.ndim and number.dtype.kind in "iuf" and 0.0 < number < np.inf, rule, error)
