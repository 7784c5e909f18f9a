"""Events of a slab in other preparations, for the second column of the table.

By the text the packing relaxes under gravity that acts at once. Gravity that grows slowly, or acts before there is
friction, makes other packings; their events are read from a summary of the group ``preparation``, so that the claims of
the paper need no other dataset of it. It has the layout of that group's dataset ``events``, and says from which file it
was made: the digest of its content and the parameters of its simulations.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from granular_response.store import files as store

from .claim import Case, Data, NotMeasured, Quantity

GROUP = "preparation"

#: The columns of the summary, what it is made of, and where it is kept.
COLUMNS = ("name", "friction", "wall_friction", "gravity", "ramp_time", "damping_ratio", "low", "high")
SOURCE = Path("extensions") / "data" / f"{GROUP}.nc"
OUTPUT = Path("extensions") / "summary.nc"

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
    for way in found[max(found)] if found else ():
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


def write(source: Path = SOURCE, output: Path = OUTPUT) -> Path:
    """Write the summary of the datasets in ``source``; returns its path.

    Raises StoreError if they cannot be read, NotMeasured if they are not those of preparations, OSError if the output
    cannot be written or is the source.
    """
    datasets, attributes = store.read(source), store.read_attributes(source)
    if attributes.get("group") != GROUP or not set(COLUMNS) <= set(datasets.get("events", ())):
        raise NotMeasured(f"{source}: holds no events of the group {GROUP}")
    events = datasets["events"].reset_coords()[list(COLUMNS)]
    made = {
        "group": GROUP,
        "source": source.name,
        "source_sha256": hashlib.sha256(source.read_bytes()).hexdigest(),
        "parameters": attributes.get("parameters", ""),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    store.check_writable(output, [source])
    store.write(output, {"events": events}, made)
    return output
