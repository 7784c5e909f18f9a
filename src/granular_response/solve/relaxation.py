"""Relaxation: nonlinear conjugate gradients on the energy of a packing without friction.

What interpolation leaves between neighbours costs Newton's method many damped steps, and near the end each of its steps
moves the border of a region of open contacts by no more than a few disks. Both are of short range. A conjugate gradient
costs no more than the forces: some of them even that out, and leave what is of long range to Newton's method, to which
it is nothing.
"""

from __future__ import annotations

import numpy as np

from ..state import FloatArray
from .system import StaticSystem

#: First length of a step along the forces, in units of the inverse normal stiffness.
FIRST = 0.15
#: A step is shortened, at most so often, where the force along it has turned by more than this part of what it was.
OVERSHOT, SHORTENED = 0.3, 4
#: Least part of a length that is kept by shortening, and from step to step; most that it grows by.
LEAST, FADES, GROWS = 0.2, 0.5, 2.0


def relaxed(system: StaticSystem, external: FloatArray, q: FloatArray, steps: int) -> FloatArray:
    """Displacements (dof,) after ``steps`` from ``q`` (dof,): Polak-Ribiere, lengths by the secant of the force.

    ``external`` : (dof,) forces of gravity and loads.
    """
    force = system.normal_forces(q) + external
    direction, square = force, float(force @ force)
    length = FIRST / system.problem.stiffness
    for _ in range(steps):
        if square == 0.0:
            break
        slope = float(force @ direction)
        if slope <= 0.0:
            direction, slope = force, square
        for _ in range(SHORTENED + 1):
            there = q + length * direction
            new = system.normal_forces(there) + external
            at_end = float(new @ direction)
            if at_end >= -OVERSHOT * slope:
                break
            length *= max(LEAST, slope / (slope - at_end))
        q = there
        direction = new + max(0.0, float(new @ (new - force)) / square) * direction
        force, square = new, float(new @ new)
        length *= float(np.clip(slope / (slope - at_end), FADES, GROWS)) if at_end < slope else GROWS
    return q
