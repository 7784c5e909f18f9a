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


def along(
    data: Data, event: str, frictions: Sequence[float], own: Mapping[float, Quantity] | None = None
) -> Iterator[tuple[Case, list[Quantity]]]:
    """The brackets of an event at some frictions beside smooth walls, in each preparation that has all of them.

    ``own`` has those without friction, which are the same in every preparation: the equilibrium is one minimum,
    whatever came before. Dashpots are the paper's. There is nothing without the summary.
    """
    found = {mu: _events(data, event, mu) for mu in frictions if mu > 0.0}
    for way in found[max(found)]:
        if way != OWN and all(way in brackets for brackets in found.values()):
            yield Case(prepared=way), [found[mu][way] if mu in found else (own or {})[mu] for mu in frictions]


def _events(data: Data, name: str, friction: float) -> dict[str, Quantity]:
    """The brackets of an event by preparation."""
    if GROUP not in data.groups:
        return {}
    found = data.get(GROUP, "events")
    found = found.isel(event=found["name"].values == name)
    damping = found["damping_ratio"].values
    here = np.isclose(found["friction"].values, friction) & (found["wall_friction"].values == 0.0)
    here &= damping == damping[:1]
    columns = (found[name].values[here].tolist() for name in ("gravity", "ramp_time", "low", "high"))
    return {_text(way, ramp): Quantity.bracket(low, high) for way, ramp, low, high in zip(*columns, strict=True)}


def _text(gravity: str, ramp_time: float) -> str:
    if gravity == "slow":
        return f"gravity grown over {ramp_time:g} sqrt(R/g)"
    return {"at-once": OWN, "frictionless": "gravity without friction first"}[gravity]
