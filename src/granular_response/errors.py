"""The base of all errors of this package, and the check that raises them."""

from __future__ import annotations


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
