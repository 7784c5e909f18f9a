"""The base of all errors of this package."""


class GranularError(Exception):
    """Something that this package cannot do as asked, and why. Most messages are one line."""


class SolveError(GranularError):
    """No equilibrium was found for a well-formed scene, or none is there."""


class EquilibriumError(SolveError, RuntimeError):
    """No static equilibrium was found near the start."""
