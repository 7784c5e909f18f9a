"""Events of a slab in other preparations, for the second column of the table.

By the text the packing relaxes under gravity that acts at once. Gravity that grows slowly, or acts before there is
friction, makes other packings; their events are read from a summary of the group ``preparation``, so that the claims of
the paper need no other dataset of it. It has the layout of that group's dataset ``events``, and says from which file it
was made: the digest of its content and the parameters of its simulations.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from granular_response.store import files as store

from .claim import PREPARATION
from .numbers import NotMeasured

#: The columns of the summary, what it is made of, and where it is kept.
COLUMNS = ("name", "friction", "wall_friction", "gravity", "ramp_time", "damping_ratio", "low", "high")
SOURCE = Path("extensions") / "data" / f"{PREPARATION}.nc"
OUTPUT = Path("extensions") / "summary.nc"


def write(source: Path = SOURCE, output: Path = OUTPUT) -> Path:
    """Write the summary of the datasets in ``source``; returns its path.

    Raises StoreError if they cannot be read, NotMeasured if they are not those of preparations, OSError if the output
    cannot be written or is the source.
    """
    datasets, attributes = store.read(source), store.read_attributes(source)
    if attributes.get("group") != PREPARATION or not set(COLUMNS) <= set(datasets.get("events", ())):
        raise NotMeasured(f"{source}: holds no events of the group {PREPARATION}")
    made = {
        "group": PREPARATION,
        "source": source.name,
        "source_sha256": hashlib.sha256(source.read_bytes()).hexdigest(),
        "parameters": attributes.get("parameters", ""),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    store.check_writable(output, [source])
    store.write(output, {"events": datasets["events"].reset_coords()[list(COLUMNS)]}, made)
    return output
