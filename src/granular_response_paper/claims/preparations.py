"""Events of a slab in other preparations, for the second column of the table.

By the text the packing relaxes under gravity that acts at once. Gravity that grows slowly, or acts before there is
friction, makes other packings; their events are read from a summary of the group ``preparation``
(:mod:`granular_response_paper.claims.summary`), so that the claims of the paper need no other dataset of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from .claim import Data, Quantity, Test

GROUP = "preparation"

#: Of the paper.
OWN = "gravity at once"


def events(data: Data, name: str, friction: float) -> dict[str, Quantity]:
    """The brackets of an event beside smooth walls, by preparation; none without the summary.

    Dashpots are the paper's. Without friction the equilibrium is one minimum, whatever came before, and there is none.
    """
    if GROUP not in data.groups or friction == 0.0:
        return {}
    found = data.get(GROUP, "events")
    found = found.isel(event=found["name"].values == name)
    damping = found["damping_ratio"].values
    here = np.isclose(found["friction"].values, friction) & (found["wall_friction"].values == 0.0)
    brackets = {
        _text(str(found["gravity"].values[k]), float(found["ramp_time"].values[k])): Quantity.bracket(
            float(found["low"].values[k]), float(found["high"].values[k])
        )
        for k in np.flatnonzero(here & (damping == damping[:1])).tolist()
    }
    return {way: bracket for way, bracket in brackets.items() if way != OWN}


def tested(
    data: Data, event: str, frictions: Sequence[float], own: Mapping[float, Quantity], tests: Callable[..., list[Test]]
) -> list[Test]:
    """Tests of the brackets of an event at some frictions, in each preparation that has all of them.

    ``tests`` makes tests of the brackets in the order of ``frictions``; ``own`` has those without friction, which are
    the same in every preparation.
    """
    found = {mu: events(data, event, mu) for mu in frictions if mu > 0.0}
    ways = [way for way in found[max(found)] if all(way in brackets for brackets in found.values())]
    return [
        replace(test, prepared=way)
        for way in ways
        for test in tests(*(found[mu][way] if mu in found else own[mu] for mu in frictions))
    ]


def _text(gravity: str, ramp_time: float) -> str:
    if gravity == "slow":
        return f"gravity grown over {ramp_time:g} sqrt(R/g)"
    return {"at-once": OWN, "frictionless": "gravity without friction first"}[gravity]
