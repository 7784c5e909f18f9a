"""Events of a slab in other preparations, for the second column of the table.

By the text the packing relaxes under gravity that acts at once. Gravity that grows slowly, or acts before there is
friction, makes other packings; their events are read from a summary of the group ``preparation``, so that the claims of
the paper need no other dataset of it. It has the layout of that group's dataset ``events``, and says from which file it
was made, by the digest that the lock of the extensions has of that file, and with which parameters.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from granular_response.inputs import read_text
from granular_response.store import files as store

from .claim import PREPARATION, ClaimsError
from .numbers import NotMeasured

#: The columns of the summary, what it is made of, and where it is kept.
COLUMNS = ("name", "friction", "wall_friction", "gravity", "ramp_time", "damping_ratio", "low", "high")
SOURCE = Path("extensions") / "data" / f"{PREPARATION}.nc"
OUTPUT = Path("extensions") / "summary.nc"


def check(summary: Path = OUTPUT) -> None:
    """Raise ClaimsError if a summary was made from other datasets than the ``dvc.lock`` beside it records.

    StoreError if it cannot be read. A summary without a lock beside it stands for itself.
    """
    lock = summary.parent / "dvc.lock"
    if not (summary.exists() and lock.exists()):
        return
    written = rf"    - path: data/{PREPARATION}\.nc\n(?:      .*\n)*?      md5: (\w+)"
    simulated = re.search(rf"^  simulate@{PREPARATION}:\n(?:   .*\n)*?{written}", read_text(lock), re.MULTILINE)
    if simulated and simulated[1] != store.read_attributes(summary).get("source_md5"):
        raise ClaimsError(
            f"{summary}: is older than {PREPARATION}.nc of {lock}; renew it by dvc repro claims in {summary.parent}"
        )


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
        "source_md5": hashlib.md5(source.read_bytes(), usedforsecurity=False).hexdigest(),
        "parameters": attributes.get("parameters", ""),
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    store.check_writable(output, [source])
    store.write(output, {"events": datasets["events"].reset_coords()[list(COLUMNS)]}, made)
    return output
