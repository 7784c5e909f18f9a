"""Time integrators, by the names that scene files have for them."""

from .schemes import Beeman, Gear, Leapfrog, Verlet
from .stepping import LOOK_EVERY, Integrator, Memory, advance, amplification, lead

INTEGRATORS: dict[str, Integrator] = {
    "beeman": Beeman(), "verlet": Verlet(), "leapfrog": Leapfrog(), "gear": Gear(),
}  # fmt: skip

__all__ = ["INTEGRATORS", "LOOK_EVERY", "Integrator", "Memory", "advance", "amplification", "lead"]
