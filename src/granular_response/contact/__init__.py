"""Contact laws: one file each for the part along the normal, one for what all have along the tangent (Sec. III.A)."""

from ..machine.machine_code import tell_apart
from .coulomb import CUT, LITERAL, RULES, UNLOADING
from .hertz import Hertz
from .law import Law, without_friction
from .linear import Linear

#: By the name that a scene file has for them.
LAWS: dict[str, type[Law]] = {"linear": Linear, "hertz": Hertz}

for _law in LAWS.values():
    tell_apart(_law)

__all__ = ["CUT", "LAWS", "LITERAL", "RULES", "UNLOADING", "Hertz", "Law", "Linear", "without_friction"]
