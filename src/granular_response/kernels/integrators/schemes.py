"""The time integrators: named tuples that predict and correct (see :mod:`.stepping`), each with its reference."""

from __future__ import annotations

from typing import NamedTuple


class Beeman(NamedTuple):
    """Remembers the acceleration ``b`` of the step before; the paper's choice (Sec. III).

    D. Beeman, J. Comput. Phys. 20, 130 (1976).
    """

    rows: int = 2
    order: int = 2

    def predict(self, x, v, a, b, c, dt):
        seen = v + (3.0 * a - b) * (0.5 * dt)
        return x + (v * dt + (4.0 * a - b) * (dt * dt / 6.0)), v, a, b, seen

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + (2.0 * a_new + 5.0 * a - b) * (dt / 6.0), a_new, a, c

    def begin(self, history) -> None:
        """No earlier step is known: take the acceleration to have been the same."""
        history[1] = history[0]


class Verlet(NamedTuple):
    """Velocity Verlet, with a velocity predicted for the full step for the dashpots. Remembers nothing.

    W. C. Swope et al., J. Chem. Phys. 76, 637 (1982).
    """

    rows: int = 1
    order: int = 2

    def predict(self, x, v, a, b, c, dt):
        return x + (v * dt + a * (0.5 * dt * dt)), v, a, b, v + a * dt

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + (a + a_new) * (0.5 * dt), a_new, b, c

    def begin(self, history) -> None:
        """Nothing to begin with."""


class Leapfrog(NamedTuple):
    """Dashpots see the velocity half-way through the step that led to the positions. Remembers nothing.

    The trajectory of velocity Verlet without dashpots. With them it bears steps twice as long, since nothing is
    extrapolated, and tangential springs follow displacements exactly; the price is first order in the dashpots.
    P. A. Cundall and O. D. L. Strack, Geotechnique 29, 47 (1979).
    """

    rows: int = 1
    order: int = 1

    def predict(self, x, v, a, b, c, dt):
        half = v + a * (0.5 * dt)
        return x + half * dt, half, a, b, half

    def correct(self, x, v, a, b, c, a_new, dt):
        return x, v + a_new * (0.5 * dt), a_new, b, c

    def begin(self, history) -> None:
        """Nothing to begin with."""


# Corrector coefficients for second-order equations whose forces depend on velocity
# (Allen & Tildesley, Computer Simulation of Liquids, App. E).
_C0, _C1, _C3, _C4 = 19.0 / 90.0, 3.0 / 4.0, 1.0 / 2.0, 1.0 / 12.0


class Gear(NamedTuple):
    """Gear's 5-value predictor-corrector, the paper's check of its integrator (Sec. III).

    Remembers the third and fourth derivatives ``b`` and ``c`` of the displacement. C. W. Gear, Argonne report ANL-7126
    (1966).
    """

    rows: int = 3
    order: int = 4

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
