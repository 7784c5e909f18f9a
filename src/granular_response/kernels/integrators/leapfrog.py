"""Leapfrog: dashpots see the velocity half-way through the step that led to the positions."""

from __future__ import annotations

from typing import NamedTuple

from .stepping import Integrator


class Leapfrog(NamedTuple):
    """Remembers nothing beyond the present acceleration.

    The trajectory of velocity Verlet without dashpots. With them it bears steps twice as long, since nothing is
    extrapolated, and tangential springs follow displacements exactly; the price is first order in the dashpots.
    """

    rows: int = 1

    def predict(self, x, v, a, b, c, dt):
        half = v + a * (0.5 * dt)
        return x + half * dt, half, a, b, half

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + a_new * (0.5 * dt), a_new, b, c

    def begin(self, history) -> None:
        """Nothing to begin with."""


RECORD = Integrator(
    name="leapfrog",
    title="leapfrog",
    order=1,
    reference="P. A. Cundall and O. D. L. Strack, Geotechnique 29, 47 (1979)",
    scheme=Leapfrog(),
)
