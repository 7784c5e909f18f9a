"""Gear's 5-value predictor-corrector, the paper's check of its integrator (Sec. III)."""

from __future__ import annotations

from typing import NamedTuple

from .stepping import Integrator

# Corrector coefficients for second-order equations whose forces depend on velocity
# (Allen & Tildesley, Computer Simulation of Liquids, App. E).
_C0, _C1, _C3, _C4 = 19.0 / 90.0, 3.0 / 4.0, 1.0 / 2.0, 1.0 / 12.0


class Gear(NamedTuple):
    """Remembers the third and fourth derivatives ``b`` and ``c`` of the displacement."""

    rows: int = 3

    def predict(self, x, v, a, b, c, dt):
        h2 = dt * dt / 2.0
        h3 = h2 * dt / 3.0
        h4 = h3 * dt / 4.0
        x = x + (v * dt + a * h2 + b * h3 + c * h4)
        v = v + (a * dt + b * h2 + c * h3)
        return x, v, a + (b * dt + c * h2), b + c * dt, v

    def correct(self, x, v, a, b, c, a_new, dt):
        change = a_new - a
        x = x + _C0 * dt * dt / 2.0 * change
        v = v + _C1 * dt / 2.0 * change
        return x, v, a_new, b + _C3 * 3.0 / dt * change, c + _C4 * 12.0 / (dt * dt) * change

    def begin(self, history) -> None:
        """Third and fourth derivatives are unknown at the start and settle within a few steps."""
        history[1:3] = 0.0


RECORD = Integrator(
    name="gear",
    title="Gear 5-value predictor-corrector",
    order=4,
    reference="C. W. Gear, Argonne report ANL-7126 (1966); the paper, Sec. III",
    scheme=Gear(),
)
