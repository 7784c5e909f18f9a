"""The largest time step that is stable for a scene.

Forces are evaluated once a step with a predicted velocity, so dashpots limit the step more than springs do. The
stiffest motions of a dense packing are (a) a disk against its six neighbours and (b) all disks turning the same
way, when every contact slips at twice the rim's speed; with a disk's small moment of inertia the second decides
in frictional scenes: its damping rate is ``24 nu_T`` for equal disks. For each motion the limit of an
integrator is found from its amplification matrix.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..core.integrators import INTEGRATORS
from .problem import Problem

#: Part of the limit that ``time_step: auto`` takes.
SAFETY = 0.6
#: Contacts around a disk of a dense packing.
NEIGHBOURS = 6


class UnstableTimeStep(ValueError):
    """The time step of a scene is beyond its stability limit."""


@lru_cache(maxsize=256)
def oscillator_limit(integrator: str, stiffness: float, damping: float) -> float:
    """Largest stable step for ``x'' = -stiffness x - damping x'``.

    The step grows until the largest eigenvalue of the amplification matrix exceeds 1 by more than 1e-4 (Gear's
    corrector is weakly unstable without damping, far below what matters in a packing).
    """
    matrix = INTEGRATORS[integrator].amplification

    def stable(dt: float) -> bool:
        return bool(np.abs(np.linalg.eigvals(matrix(stiffness * dt * dt, damping * dt))).max() <= 1.0 + 1e-4)

    step = 1e-3 / max(np.sqrt(stiffness), damping, 1e-300)
    while stable(1.1 * step) and step < 1e6:
        step *= 1.1
    unstable = 1.1 * step
    for _ in range(20):
        middle = 0.5 * (step + unstable)
        step, unstable = (middle, unstable) if stable(middle) else (step, middle)
    return float(step)


def stability_limit(problem: Problem, integrator: str | None = None, *, smallest: bool = False) -> float:
    """Estimated largest stable time step in sqrt(R/g).

    ``integrator`` : that of the scene unless given. ``smallest`` : for a disk of the smallest mass in place of the
    mean one; the estimate is then on the safe side for a disordered packing.
    """
    integrator = problem.scene.protocol.integrator if integrator is None else integrator
    mass = problem.packing.mass.min() if smallest else 1.0
    pair, wall = problem.pair_law, problem.wall_law
    k, nu = max(pair[0], 0.5 * wall[0]), max(pair[1], 0.5 * wall[1])
    kt = max(pair[2], 0.5 * wall[2]) if problem.pair_friction else 0.0
    nut = max(pair[3], 0.5 * wall[3]) if problem.pair_friction else 0.0
    motions = [(NEIGHBOURS * (k + kt) / mass, NEIGHBOURS * (nu + nut) / mass)]
    if problem.pair_friction:
        motions.append((4 * NEIGHBOURS * kt / mass, 4 * NEIGHBOURS * nut / mass))
    elif problem.wall_friction:
        motions.append((2 * wall[2] / mass, 2 * wall[3] / mass))
    return min(oscillator_limit(integrator, float(w2), float(c)) for w2, c in motions)


def resolve_time_step(problem: Problem) -> float:
    """The scene's time step, or the safe one for ``auto``.

    Raises
    ------
    UnstableTimeStep
        When the given step exceeds the limit.
    """
    step = problem.scene.protocol.time_step
    if step == "auto":
        return SAFETY * stability_limit(problem, smallest=True)
    limit = stability_limit(problem)
    if step > limit:
        raise UnstableTimeStep(
            f"protocol.time_step: {step:g} is unstable with {problem.scene.protocol.integrator}, "
            f"must be at most {limit:.3g} for this scene, or auto"
        )
    return float(step)
