"""What an increment of a path leaves out: it knows each contact at its beginning and at its end, not between.

Where contacts go on sliding, sticking or opening, the return map is exact for any length. An increment is wrong by what
a contact does that stops sliding within it, or slides for a part of it. So two increments are compared with a single
one over both. A contact that stops sliding in the first of them is the same to all of these, wherever it did: for the
single one it slides on for half of the first at the rate it had, so that the comparison has that error too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..state import SLIDING, STICKING, FloatArray
from .equilibrium import external_force
from .increment import HASTY, Work, solve_increment
from .system import Configuration, StaticSystem, Trial


@dataclass(frozen=True)
class Place:
    """An equilibrium on a path, and how contacts slid on the way to it."""

    factor: float
    known: Configuration
    trial: Trial
    sliding: FloatArray | None = None  #: (m + w,) slip per load factor in the last increment; None where nobody knows


def slip(system: StaticSystem, before: Trial, after: Trial) -> FloatArray:
    """(m + w,) by which contacts have slid in the increment between two trials (mean radii)."""
    unlimited = (np.full_like(before.pair_normal, np.inf), np.full_like(before.wall_normal, np.inf))
    stuck = system.trial(before.configuration, after.configuration.q, unlimited)
    return stuck.configuration.springs - after.configuration.springs


def error_of_two(system: StaticSystem, start: Place, middle: Place, end: Place, work: Work) -> float:
    """Largest difference of a force of the floor or a wall from that of a single increment (mean disk weights).

    Infinite where Newton's method does not find the single one. Most contacts do the same in it, so from the end of the
    two it is found with their last factorisation.
    """
    problem = system.problem
    known = start.known
    if start.sliding is not None:
        stops = (np.abs(start.trial.sense) == SLIDING) & (middle.trial.status == STICKING)
        slid_on = np.where(stops, 0.5 * abs(middle.factor - start.factor) * start.sliding, 0.0)
        pairs = len(known.pair_spring)
        known = replace(
            known,
            pair_spring=known.pair_spring - slid_on[:pairs],
            wall_spring=known.wall_spring - slid_on[pairs:],
        )
    external = external_force(problem, end.factor)
    single = solve_increment(system, known, external, end.known.q, work, passing=True, stubborn=False, patience=HASTY)
    if single is None:
        return np.inf
    normal = np.abs(single.wall_normal - end.trial.wall_normal).max(initial=0.0)
    return max(float(normal), float(np.abs(single.wall_tangential - end.trial.wall_tangential).max(initial=0.0)))
