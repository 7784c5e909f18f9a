"""Velocity Verlet with a full-step predicted velocity for the dashpots."""

from __future__ import annotations

from typing import NamedTuple

from .stepping import Integrator


class Verlet(NamedTuple):
    """Remembers nothing beyond the present acceleration."""

    rows: int = 1

    def predict(self, x, v, a, b, c, dt):
        return x + (v * dt + a * (0.5 * dt * dt)), v, a, b, v + a * dt

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + (a + a_new) * (0.5 * dt), a_new, b, c

    def begin(self, history) -> None:
        """Nothing to begin with."""


RECORD = Integrator(
    name="verlet",
    title="velocity Verlet",
    order=2,
    reference="W. C. Swope et al., J. Chem. Phys. 76, 637 (1982)",
    scheme=Verlet(),
)
