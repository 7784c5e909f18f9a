"""How far to go along a Newton step: to where the energy's slope along it has nearly vanished."""

from __future__ import annotations

from ..state import FloatArray
from .system import Configuration, StaticSystem, Trial

#: Most trials, and the part of an interval that its ends keep to themselves.
TRIALS, MARGIN = 8, 0.05


def shortened(
    system: StaticSystem,
    known: Configuration,
    external: FloatArray,
    q: FloatArray,
    step: FloatArray,
    slope: float,
    *,
    limits: FloatArray | None = None,
    full: Trial | None = None,
    until: float,
    beyond: float = 0.0,
) -> tuple[FloatArray, Trial]:
    """The step, or the part of it that goes far enough, and the trial there; never more than the step.

    Parameters
    ----------
    system, known, external, limits : as of ``StaticSystem.trial``; ``q``, ``step`` : (dof,) where from and where to.
    slope : force along ``step`` at ``q``, positive: the energy falls.
    full : the trial at the end of the step, if it is known.
    until : part of ``slope`` to which the force along the step must have fallen.
    beyond : part of ``slope`` with which the full step may lead uphill again.
    """
    trial = system.trial(known, q + step, limits=limits) if full is None else full
    low, at_low = 0.0, slope
    high, at_high = 1.0, float((trial.contact_force + external) @ step)
    if at_high >= -beyond * slope:
        return step, trial
    for k in range(TRIALS):
        secant = low + (high - low) * at_low / (at_low - at_high)
        part = secant if k % 2 == 0 else 0.5 * (low + high)
        part = min(max(part, low + MARGIN * (high - low)), high - MARGIN * (high - low))
        trial = system.trial(known, q + part * step, limits=limits)
        here = float((trial.contact_force + external) @ step)
        if abs(here) < until * slope:
            break
        if here > 0:
            low, at_low = part, here
        else:
            high, at_high = part, here
    return part * step, trial
