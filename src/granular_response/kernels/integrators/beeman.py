"""Beeman's algorithm, the paper's choice (Sec. III)."""

from __future__ import annotations

from typing import NamedTuple

from .stepping import Integrator


class Beeman(NamedTuple):
    """Remembers the acceleration ``b`` of the step before."""

    rows: int = 2

    def predict(self, x, v, a, b, c, dt):
        seen = v + (3.0 * a - b) * (0.5 * dt)
        return x + (v * dt + (4.0 * a - b) * (dt * dt / 6.0)), v, a, b, seen

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + (2.0 * a_new + 5.0 * a - b) * (dt / 6.0), a_new, a, c

    def begin(self, history) -> None:
        """No earlier step is known: take the acceleration to have been the same."""
        history[1] = history[0]


RECORD = Integrator(
    name="beeman",
    title="Beeman",
    order=2,
    reference="D. Beeman, J. Comput. Phys. 20, 130 (1976); the paper, Sec. III",
    scheme=Beeman(),
)
