"""The contact law once more, in plain Python: what kernels are held against."""

from dataclasses import dataclass

import numpy as np

from granular_response.contact import Linear


@dataclass
class Material:
    """Constants of one kind of contact."""

    kn: float = 3000.0
    nun: float = 54.0
    kt: float = 2400.0
    nut: float = 49.0
    mu: float = 0.2
    least: float = -np.inf

    @property
    def law(self):
        return Linear(self.kn, self.nun, self.kt, self.nut, self.mu, self.least)


def contact_force(m: Material, overlap, velocity_normal, velocity_tangential, spring, dt, rule="cut"):
    """Normal force, tangential force and new spring of a closed contact (docs/architecture.md for the signs)."""
    fn = max(m.kn * overlap - m.nun * velocity_normal, m.least)
    if rule != "cut":
        unloads = rule == "unloading" and spring * velocity_tangential < 0.0
        if m.kt * abs(spring) < m.mu * abs(fn) or unloads:
            spring = spring + velocity_tangential * dt
        return fn, -m.kt * spring - m.nut * velocity_tangential, spring
    new = spring + velocity_tangential * dt
    ft = -m.kt * new - m.nut * velocity_tangential
    limit = m.mu * abs(fn)
    if abs(ft) > limit:
        ft = limit if ft > 0 else -limit
        new = -(ft + m.nut * velocity_tangential) / m.kt
    return fn, ft, new
