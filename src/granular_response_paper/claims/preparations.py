"""Events of a slab in other preparations, for the second column of the table.

By the text the packing relaxes under gravity that acts at once. Gravity that grows slowly, or acts before there is
friction, makes other packings; their events are read from a summary of the group ``preparation``
(:mod:`granular_response_paper.claims.summary`), so that the claims of the paper need no other dataset of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .claim import Case, Data, Quantity

GROUP = "preparation"

#: Of the paper.
OWN = "gravity at once"


def events(data: Data, name: str, friction: float) -> list[tuple[Case, Quantity]]:
    """The brackets of an event beside smooth walls, by preparation; none without the summary.

    Dashpots are the paper's. Without friction the equilibrium is one minimum, whatever came before, and there is none.
    """
    if GROUP not in data.groups or friction == 0.0:
        return []
    found = data.get(GROUP, "events")
    found = found.isel(event=found["name"].values == name)
    damping = found["damping_ratio"].values
    here = np.isclose(found["friction"].values, friction) & (found["wall_friction"].values == 0.0)
    here &= damping == damping[:1]
    columns = (found[name].values[here].tolist() for name in ("gravity", "ramp_time", "low", "high"))
    brackets = {_text(way, ramp): Quantity.bracket(low, high) for way, ramp, low, high in zip(*columns, strict=True)}
    return [(Case(prepared=way), bracket) for way, bracket in brackets.items() if way != OWN]


def along(
    data: Data, event: str, frictions: Sequence[float], own: Mapping[float, Quantity]
) -> Iterator[tuple[Case, list[Quantity]]]:
    """The brackets of an event at some frictions, in each preparation that has all of them, by its name.

    ``own`` has those without friction, which are the same in every preparation.
    """
    found = {mu: {way.prepared: one for way, one in events(data, event, mu)} for mu in frictions if mu > 0.0}
    for way in found[max(found)]:
        if all(way in brackets for brackets in found.values()):
            yield Case(prepared=way), [found[mu][way] if mu in found else own[mu] for mu in frictions]


def _text(gravity: str, ramp_time: float) -> str:
    if gravity == "slow":
        return f"gravity grown over {ramp_time:g} sqrt(R/g)"
    return {"at-once": OWN, "frictionless": "gravity without friction first"}[gravity]
