"""The summary of other preparations: what the claims of the paper read of the group ``preparation``.

It has the layout of that group's dataset ``events``, so that :meth:`Data.get` finds it, and says from which file it was
made: the digest of its content and the parameters of its simulations.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from granular_response.store import files as store

from .claim import NotMeasured
from .preparations import GROUP

#: The dataset, its columns, where it is read from, and where the summary is kept.
EVENTS = "events"
COLUMNS = ("name", "friction", "wall_friction", "gravity", "ramp_time", "damping_ratio", "low", "high")
SOURCE = Path("extensions") / "data" / f"{GROUP}.nc"
OUTPUT = Path("extensions") / "summary.nc"


def write(source: Path = SOURCE, output: Path = OUTPUT) -> Path:
    """Write the summary of the datasets in ``source``; returns its path.

    Raises StoreError if they cannot be read, NotMeasured if they are not those of preparations, OSError if the output
    cannot be written or is the source.
    """
    datasets, attributes = store.read(source), store.read_attributes(source)
    if attributes.get("group") != GROUP or not set(COLUMNS) <= set(datasets.get(EVENTS, ())):
        raise NotMeasured(f"{source}: holds no events of the group {GROUP}")
    events = datasets[EVENTS].reset_coords()[list(COLUMNS)]
    made = {
        "group": GROUP,
        "source": source.name,
        "source_sha256": hashlib.sha256(source.read_bytes()).hexdigest(),
        "parameters": attributes.get("parameters", ""),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    store.check_writable(output, [source])
    store.write(output, {EVENTS: events}, made)
    return output
