"""Time integrators, a file each: a named tuple that predicts and corrects (see :mod:`.stepping`)."""

from . import beeman, gear, leapfrog, verlet
from .stepping import LOOK_EVERY, Integrator, Memory, advance, amplification

INTEGRATORS: dict[str, Integrator] = {module.RECORD.name: module.RECORD for module in (beeman, verlet, leapfrog, gear)}

__all__ = ["INTEGRATORS", "LOOK_EVERY", "Integrator", "Memory", "advance", "amplification"]
