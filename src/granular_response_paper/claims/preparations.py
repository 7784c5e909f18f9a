"""How else a slab can be prepared and loaded, for claims that hang on it.

By the text the packing relaxes under gravity, which acts at once; other preparations are variants, measured in the
group ``preparation``. The text does not say how long the force grows, and its equation for the spring differs from its
words: the group ``sensitivity`` has responses at 15 mg in these interpretations.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from granular_response.observe.peaks import central_dip

from . import asked
from .claim import Condition, Data, Quantity, Reading
from .words import Bounds

GROUP, LOADING = "preparation", "sensitivity"

#: What other preparations change.
CHANGE = "gravity"

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
    study = data.get(LOADING, f"mu_{friction:g}", "variant", "x", "floor_response")
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
    found = data.get(GROUP, "events", "name", "low", "high", *_LABELS)
    here = (found["name"].values == name) & _cases(found, friction, wall_friction)
    return {
        _text(found, k): Quantity.bracket(float(found["low"].values[k]), float(found["high"].values[k]))
        for k in np.flatnonzero(here).tolist()
        if _text(found, k) != _text(found, 0)
    }


def readings(
    data: Data, name: str, frictions: tuple[float, ...], conditions: Callable[..., list[Condition]]
) -> list[Reading]:
    """A variant for each other way to bring gravity of which the event is stored at all ``frictions``.

    ``conditions`` makes its conditions of the brackets in that order.
    """
    found = [events(data, name, friction) for friction in frictions]
    return [
        Reading(way, *conditions(*(brackets[way] for brackets in found)), change=CHANGE)
        for way in found[-1]
        if all(way in brackets for brackets in found)
    ]


def curves(data: Data, friction: float, variable: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Forces and what is measured there, for each other way to bring gravity; none without the study."""
    if GROUP not in data.groups:
        return {}
    study = data.get(GROUP, "response", "force", variable, *_LABELS)
    found = {}
    for k in np.flatnonzero(_cases(study, friction, 0.0)).tolist():
        values = study[variable].transpose("case", "force").values[k]
        known = np.isfinite(values)
        if _text(study, k) != _text(study, 0):
            found[_text(study, k)] = study["force"].values[known], values[known]
    return found


_LABELS = ("gravity", "ramp_time", "damping_ratio", "friction", "wall_friction")


def _cases(found: xr.Dataset, friction: float, wall_friction: float) -> np.ndarray:
    """Where the friction is this and the dashpots are those of the first case."""
    damping = found["damping_ratio"].values
    return (
        np.isclose(found["friction"].values, friction)
        & np.isclose(found["wall_friction"].values, wall_friction)
        & (damping == damping[0])
    )


def _text(found: xr.Dataset, k: int) -> str:
    gravity = str(found["gravity"].values[k])
    if gravity == "slow":
        return f"gravity grown over {float(found['ramp_time'].values[k]):g} sqrt(R/g)"
    return {"at-once": "gravity at once", "frictionless": "gravity without friction first"}[gravity]
