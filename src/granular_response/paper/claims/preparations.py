"""Floor responses at 15 mg under other readings of how a slab is prepared and loaded (the study ``sensitivity``)."""

from __future__ import annotations

import math

import numpy as np

from granular_response.observe.peaks import central_dip

from .claim import Condition, Data, Quantity, Reading
from .words import Bounds

GROUP = "sensitivity"

#: Readings that the text leaves open, by variant: it says neither how gravity comes nor how long the force grows, and
#: its equation for the spring differs from its words.
OPEN = {
    "slow_gravity": "gravity grown slowly",
    "ramp_80": "force grown over 80 sqrt(R/g)",
    "path": "quasi-static path",
    "literal_friction": "the spring's equation as printed",
}

#: Distance from the side walls within which peaks do not count (mean radii).
WALL = 10.0


def dips(data: Data, friction: float) -> dict[str, float]:
    """Central dip of the floor response at 15 mg, per largest response, by reading."""
    study = data.get(GROUP, f"mu_{friction:g}", "variant", "x", "floor_response")
    x, names = study["x"].values, study["variant"].values.tolist()
    inside = np.abs(x) < np.abs(x).max() - WALL
    return {
        text: central_dip(x, study["floor_response"].values[names.index(variant)], interior=inside)
        for variant, text in OPEN.items()
        if variant in names
    }


def crossovers(data: Data, friction: float) -> dict[str, Quantity]:
    """By reading, that the crossover comes before 15 mg where the response there has two peaks; none without the study.

    A response with one peak says only that it comes later, if at all, and is left out.
    """
    if GROUP not in data.groups:
        return {}
    before = math.nextafter(15.0, 0.0)
    return {name: Quantity.bracket(0.0, before) for name, dip in dips(data, friction).items() if dip > 0.0}


def one_peak_at_15(data: Data, friction: float, words: Bounds) -> list[Reading]:
    """That the response at 15 mg has one peak, in each of the other readings; none without the study."""
    if GROUP not in data.groups:
        return []
    return [
        Reading(
            f"{name} (15 mg)",
            Condition(
                "dip at x = 0 at 15 mg", Quantity.exact(dip), most=words["visible"], words=("visible",), unit="%"
            ),
        )
        for name, dip in dips(data, friction).items()
    ]
