"""Linear springs: eqs. (2) and (3) of the paper."""

from __future__ import annotations

from typing import NamedTuple


class Linear(NamedTuple):
    """Normal force in proportion to the overlap; see :mod:`.law`."""

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float
    friction: float
    least_force: float

    @classmethod
    def of(cls, *constants: float) -> Linear:
        """The law from the constants of :meth:`.law.Law.of`; the last one, a radius, does not matter."""
        return cls._make(constants[:-1])

    def elastic_force(self, overlap, shape):
        return self.normal_stiffness * overlap

    def stiffness(self, overlap, shape):
        return self.normal_stiffness

    def energy(self, overlap, shape):
        return 0.5 * self.normal_stiffness * overlap * overlap

    def shapes(self, first, second):
        return None

    def stiffest(self, force: float) -> float:
        return self.normal_stiffness
