"""What an increment of a path leaves out: it knows each contact at its beginning and at its end, not between.

Where contacts go on sliding, sticking or opening, the return map is exact for any length. An increment is wrong by what
a contact does that stops sliding within it, or slides for a part of it. So two increments are compared with a single
one over both. Three things are the same to all of these, and looked for:

* A contact that stops sliding in the first of them does, wherever it did. For the single one it slides on for half of
  the first at the rate it had.
* A contact that has slid and stopped again within an increment, when another one began to slide, ends as one that
  slides. Only further on does it stick at once. Then it counts as having stuck for half of the increment.
* A contact that begins to slide and stops within an increment sticks at both ends. At the rate of the increment before
  it would have passed Coulomb's limit. Then it counts as having slid by half of that.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..state import SLIDING, STICKING, FloatArray
from .equilibrium import external_force
from .increment import HASTY, Work, solve_increment
from .system import Configuration, StaticSystem, Trial

#: Length of the increment that looks ahead, as a part of the one before or after it.
AHEAD = 0.01


@dataclass(frozen=True)
class Ahead:
    """How contacts go on from a state, per load factor (mean radii)."""

    slip: FloatArray  #: (m + w,) by which they slide
    release: FloatArray  #: (m + w,) by which springs of those that slid fall behind Coulomb's limit


@dataclass
class Place:
    """An equilibrium on a path, where it came from and how contacts go on from it."""

    factor: float
    known: Configuration
    trial: Trial
    before: Place | None = None  #: the last one; None where nothing is known of it
    ahead: Ahead | None = None  #: None where nobody has looked


def _limits(system: StaticSystem, trial: Trial) -> FloatArray:
    """(m + w,) lengths of springs at Coulomb's limit (mean radii), infinite without friction."""
    parts = []
    for law, normal in ((system.problem.pair_law, trial.pair_normal), (system.problem.wall_law, trial.wall_normal)):
        rubs = law.friction > 0.0 and law.tangential_stiffness > 0.0
        parts.append(law.friction / law.tangential_stiffness * normal if rubs else np.full_like(normal, np.inf))
    return np.concatenate(parts)


def slip(system: StaticSystem, before: Trial, after: Trial) -> FloatArray:
    """(m + w,) by which contacts have slid in the increment between two trials (mean radii)."""
    unlimited = (np.full_like(before.pair_normal, np.inf), np.full_like(before.wall_normal, np.inf))
    stuck = system.trial(before.configuration, after.configuration.q, unlimited)
    return stuck.configuration.springs - after.configuration.springs


def _one_step(system: StaticSystem, place: Place, known: Configuration, factor: float) -> Trial | None:
    """One step of Newton's method from a place, to ``factor`` after ``known``; None where its tangent has no inverse.

    With the tangent of the place, which has been factorised: contacts that slid there are taken to slide on, and the
    trial says for which of them that was wrong.
    """
    beside = system.displaced(known.q, factor)
    force = system.trial(known, beside).contact_force + external_force(system.problem, factor)
    try:
        step = system.nearby_step(place.trial, force)
    except RuntimeError:  # exactly singular
        return None
    return system.trial(known, beside + step) if np.isfinite(step).all() else None


def look_ahead(system: StaticSystem, place: Place, length: float, work: Work) -> Ahead:
    """How contacts go on from a place, over a small increment of load factor ``length``.

    Where one step says that all that slid slide on, they do. Where it says otherwise one that sticks may keep another
    one sliding, which only the solution tells.
    """
    new = place.factor + length
    found = _one_step(system, place, place.known, new)
    if found is None or _stops(place, found).any():
        guess = system.displaced(place.known.q, new)
        external = external_force(system.problem, new)
        found = solve_increment(system, place.known, external, guess, work, stubborn=False, patience=HASTY)
    if found is None:
        return Ahead(np.zeros(len(place.trial.status)), np.zeros(len(place.trial.status)))
    return Ahead(slip(system, place.trial, found) / abs(length), _release(system, place, found, abs(length)))


def _stops(place: Place, ahead: Trial) -> np.ndarray:
    """(m + w,) whether a contact slid and sticks a little further on."""
    return (place.trial.status == SLIDING) & (ahead.status == STICKING)


def _release(system: StaticSystem, place: Place, ahead: Trial, length: float) -> FloatArray:
    """(m + w,) by which springs that slid at a place fall behind Coulomb's limit, per load factor."""
    return np.where(_stops(place, ahead), _limits(system, ahead) - np.abs(ahead.configuration.springs), 0.0) / length


def _passed_over(system: StaticSystem, middle: Place, end: Place) -> FloatArray:
    """(m + w,) by which contacts that stick at both ends may have slid between, as far as their springs tell."""
    start = middle.before
    if start is None:
        return np.zeros(len(end.trial.status))
    ratio = (end.factor - middle.factor) / (middle.factor - start.factor)
    spring = middle.known.springs + ratio * (middle.known.springs - start.known.springs)
    limit, before = _limits(system, middle.trial), _limits(system, start.trial)
    finite = np.isfinite(limit) & (start.trial.status == STICKING)
    sticks = finite & (middle.trial.status == STICKING) & (end.trial.status == STICKING)
    over = np.zeros_like(spring)
    over[sticks] = np.abs(spring[sticks]) - (limit[sticks] + ratio * (limit[sticks] - before[sticks]))
    return 0.5 * np.sign(spring) * np.maximum(over, 0.0)


def error_of_two(system: StaticSystem, start: Place, middle: Place, end: Place, work: Work) -> float:
    """Largest difference of a force of the floor or a wall that two increments may be wrong by (mean disk weights).

    Infinite where Newton's method does not find the single one. Most contacts do the same in it, so from the end of the
    two it is found with their last factorisation.
    """
    first, second = middle.factor - start.factor, end.factor - middle.factor
    known = start.known
    sticks = middle.trial.status == STICKING
    if start.ahead is None and (start.before is None or (sticks & (start.trial.status == SLIDING)).any()):
        start.ahead = look_ahead(system, start, AHEAD * first, work)
    if start.ahead is not None:
        known = _with_springs(known, known.springs - np.where(sticks, 0.5 * abs(first) * start.ahead.slip, 0.0))
    external = external_force(system.problem, end.factor)
    single = solve_increment(system, known, external, end.known.q, work, passing=True, stubborn=False, patience=HASTY)
    if single is None:
        return np.inf
    error = _difference(single, end.trial)
    if np.array_equal(start.trial.sense, end.trial.sense) and np.array_equal(start.trial.sense, middle.trial.sense):
        return error
    springs = end.known.springs
    stuck = 0.5 * abs(first) * _release(system, middle, end.trial, abs(second))
    if SLIDING in end.trial.status:
        end.ahead = look_ahead(system, end, AHEAD * second, work)
        stuck += 0.5 * abs(second) * end.ahead.release
    missed = np.where(end.trial.status == STICKING, _passed_over(system, start, middle), 0.0)
    missed += _passed_over(system, middle, end) + np.sign(springs) * np.minimum(stuck, np.abs(springs))
    if missed.any():
        other = _one_step(system, end, _with_springs(end.known, end.known.springs - missed), end.factor)
        error += np.inf if other is None else _difference(other, end.trial)
    return error


def _with_springs(known: Configuration, springs: FloatArray) -> Configuration:
    pairs = len(known.pair_spring)
    return replace(known, pair_spring=springs[:pairs], wall_spring=springs[pairs:])


def _difference(one: Trial, other: Trial) -> float:
    """Largest difference of a force of the floor or a wall (mean disk weights)."""
    normal = float(np.abs(one.wall_normal - other.wall_normal).max(initial=0.0))
    return max(normal, float(np.abs(one.wall_tangential - other.wall_tangential).max(initial=0.0)))
