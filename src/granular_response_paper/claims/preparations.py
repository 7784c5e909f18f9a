"""How else a slab can be prepared and loaded, for claims that hang on it.

By the text the packing relaxes under gravity, which acts at once; other preparations are variants, measured in the
group ``preparation``. The text does not say how long the force grows, and its equation for the spring differs from its
words: the group ``sensitivity`` has responses at 15 mg in these interpretations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from granular_response.observe.peaks import central_dip

from . import asked
from .claim import Condition, Data, Quantity, Reading
from .words import Bounds

GROUP, LOADING = "preparation", "sensitivity"

#: The paper's preparation, and what others change.
OWN, CHANGE = "gravity at once", "gravity"

#: Other readings, by variant of ``sensitivity``; all but the first are interpretations.
OPEN = {
    "slow_gravity": "gravity grown slowly",
    "ramp_80": "force grown over 80 sqrt(R/g)",
    "path": "quasi-static path",
    "literal_friction": "the spring's equation as printed",
    "unloading_friction": "the spring frozen at the limit, free to unload",
}

#: Distance from the side walls within which peaks do not count (mean radii).
WALL = 10.0


def dips(data: Data, friction: float) -> dict[str, float]:
    """Central dip of the floor response at 15 mg, per largest response, by reading."""
    study = data.get(LOADING, f"mu_{friction:g}")
    x, names = study["x"].values, study["variant"].values.tolist()
    inside = np.abs(x) < np.abs(x).max() - WALL
    return {
        text: central_dip(x, study["floor_response"].values[names.index(variant)], interior=inside)
        for variant, text in OPEN.items()
        if variant in names
    }


def one_peak_at_15(data: Data, friction: float, words: Bounds) -> list[Reading]:
    """That the response at 15 mg has one peak, in each of the other readings; none without the study."""
    if LOADING not in data.groups:
        return []
    return [
        Reading(
            f"{name} (15 mg)",
            asked.at_most("dip at x = 0 at 15 mg", dip, words, "visible", "%"),
            change=change(name),
        )
        for name, dip in dips(data, friction).items()
    ]


def change(name: str) -> str:
    """What a reading of ``OPEN`` changes."""
    return CHANGE if name == OPEN["slow_gravity"] else ""


def events(data: Data, name: str, friction: float, wall_friction: float = 0.0) -> dict[str, Quantity]:
    """The brackets of an event for each other way to bring gravity; none without the study.

    Dashpots are the paper's. Without friction the equilibrium is one minimum, whatever came before, and there is none.
    """
    if GROUP not in data.groups:
        return {}
    found = data.get(GROUP, "events")
    found = found.isel(event=found["name"].values == name)
    low, high = found["low"].values, found["high"].values
    return {way: Quantity.bracket(low[k], high[k]) for way, k in _cases(found, friction, wall_friction).items()}


def readings(
    data: Data,
    event: str,
    paper: Mapping[float, Quantity],
    conditions: Callable[..., list[Condition]],
    own: str = OWN,
    named: str = "",
) -> list[Reading]:
    """What is asked of the brackets of an event at some frictions, with gravity at once and brought in each other way.

    ``conditions`` makes conditions of the brackets, in the order of those of the ``paper``'s preparation, whose reading
    is ``own``. Those without friction are the same in all ways; a way without the event at a friction is left out.
    ``named`` begins the names of the others.
    """
    found = {friction: events(data, event, friction) for friction in paper if friction > 0.0}
    every = [way for way in found.get(list(paper)[-1], {}) if all(way in brackets for brackets in found.values())]
    ways = {way: [found[mu][way] if mu in found else bracket for mu, bracket in paper.items()] for way in every}
    others = [Reading(named + way, *conditions(*brackets), change=CHANGE) for way, brackets in ways.items()]
    return [Reading(own, *conditions(*paper.values())), *others]


def responses(data: Data, friction: float) -> dict[str, xr.Dataset]:
    """What is measured along the force, for each other way to bring gravity; none without the study."""
    if GROUP not in data.groups:
        return {}
    study = data.get(GROUP, "response")
    return {way: study.isel(case=k) for way, k in _cases(study, friction, 0.0).items()}


def _cases(found: xr.Dataset, friction: float, wall_friction: float) -> dict[str, int]:
    """Where the friction is this and the dashpots are those of the first case, by the other ways to bring gravity."""
    damping = found["damping_ratio"].values
    here = (
        np.isclose(found["friction"].values, friction)
        & np.isclose(found["wall_friction"].values, wall_friction)
        & (damping == damping[:1])
    )
    ways = {_text(found, k): k for k in np.flatnonzero(here).tolist()}
    return {way: k for way, k in ways.items() if way != _text(found, 0)}


def _text(found: xr.Dataset, k: int) -> str:
    gravity = str(found["gravity"].values[k])
    if gravity == "slow":
        return f"gravity grown over {float(found['ramp_time'].values[k]):g} sqrt(R/g)"
    return {"at-once": OWN, "frictionless": "gravity without friction first"}[gravity]
