"""The largest time step that is safe for a scene.

The fastest motion is that of a disk held by all its contacts. With stiffness ``K`` and damping ``C`` summed over
contacts and divided by mass or moment of inertia, explicit integration with one force evaluation per step is
stable while both the oscillation and the decay are resolved; rotations decide, since a disk's moment of
inertia is half of its mass times radius squared.
"""

from __future__ import annotations

import numpy as np

from .problem import Problem

#: Part of the estimated limit that is used.
SAFETY = 0.5
#: Contacts around a disk of a dense packing.
NEIGHBOURS = 6


class UnstableTimeStep(ValueError):
    """The time step of a scene is beyond its stability limit."""


def stability_limit(problem: Problem) -> float:
    """Estimated largest stable time step in sqrt(R/g).

    For one mode with frequency ``w`` and damping ``c`` (rate) the limit is
    ``2 / (c / 2 + sqrt(w^2 + c^2 / 4))``, the positive root of ``dt^2 w^2 / 4 + dt c / 4 = 1``.
    """
    limit = np.inf
    mass, inertia, radius = problem.packing.mass, problem.packing.inertia, problem.packing.radius
    k = max(problem.pair_law[0], 0.5 * problem.wall_law[0])
    nu = max(problem.pair_law[1], 0.5 * problem.wall_law[1])
    kt = max(problem.pair_law[2], 0.5 * problem.wall_law[2]) if problem.rotations else 0.0
    nut = max(problem.pair_law[3], 0.5 * problem.wall_law[3]) if problem.rotations else 0.0
    least = float(mass.min())
    # translation against neighbours moving the opposite way: half the contacts act along any direction
    modes = [(2 * NEIGHBOURS / 2 * (k + kt) / least, 2 * NEIGHBOURS / 2 * (nu + nut) / least)]
    if problem.rotations:
        arm = float((radius**2 / inertia).max())
        modes.append((2 * NEIGHBOURS * kt * arm, 2 * NEIGHBOURS * nut * arm))
    for stiffness, damping in modes:
        root = 0.5 * damping + np.sqrt(stiffness + 0.25 * damping**2)
        if root > 0:
            limit = min(limit, 2.0 / root)
    return float(limit)


def resolve_time_step(problem: Problem) -> float:
    """The scene's time step, or the safe one for ``auto``.

    Raises
    ------
    UnstableTimeStep
        When the given step exceeds the limit.
    """
    step = problem.scene.protocol.time_step
    limit = stability_limit(problem)
    if step == "auto":
        return SAFETY * limit
    if step > limit:
        raise UnstableTimeStep(
            f"protocol.time_step: {step:g} is unstable for this scene, must be at most {limit:.3g} (or auto)"
        )
    return float(step)
