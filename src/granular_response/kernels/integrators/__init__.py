"""Time integrators, a file each: a named tuple that predicts and corrects (see :mod:`.stepping`)."""

from .beeman import Beeman
from .gear import Gear
from .stepping import LOOK_EVERY, Integrator, Memory, advance, amplification
from .verlet import Verlet

INTEGRATORS: dict[str, Integrator] = {kind.name: kind() for kind in (Beeman, Verlet, Gear)}

__all__ = ["INTEGRATORS", "LOOK_EVERY", "Integrator", "Memory", "advance", "amplification"]
