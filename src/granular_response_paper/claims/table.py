"""The paper's claims against the stored datasets: the table with a verdict for each, and how firm the counts are.

``collect`` reads what is stored, ``evaluate`` judges, ``document`` makes the JSON that ``dvc metrics show``, the
report and the README quote.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any

from granular_response.store import atomic
from granular_response.store import files as store

from ..groups import NAMES
from . import preparations, sentences
from .changes import CHANGES
from .claim import Claim, Data, Quantity, rounded
from .stored import OUTPUT, ClaimsError
from .verdict import MEANINGS, ROBUSTNESS_MEANINGS, Entry, Verdict, judge, key
from .words import TABLE, bounds

#: Kinds of claims by the first letter, in the order of the table.
_ORDER = "AFRKSPTDUNB"


def _place(claim: Claim) -> tuple[int, int, str]:
    letter, number, part = re.fullmatch(r"([A-Z])(\d+)([a-z]?)", claim.id).groups()  # type: ignore[union-attr]
    return _ORDER.index(letter), int(number), part


def _claims_of(group: str) -> Sequence[Claim]:
    """The claims of a group; none if it has no ``claims.py``."""
    name = f"granular_response_paper.groups.{group}.claims"
    return import_module(name).CLAIMS if find_spec(name) else ()


#: All claims in the order of the table.
CLAIMS: tuple[Claim, ...] = tuple(sorted((claim for group in NAMES for claim in _claims_of(group)), key=_place))

#: Figure groups whose datasets the claims read.
GROUPS: tuple[str, ...] = tuple(
    sorted({claim.group for claim in CLAIMS} | {preparations.GROUP, preparations.LOADING, sentences.MEANS})
)

#: How the bounds of words are changed to see how the counts move.
FACTORS = (0.5, 2.0)

#: Intervals as they are named for readers.
KINDS = {"none": "", "bracket": "bracket", "confidence": "95 % confidence", "range": "range"}


def collect(folder: str | os.PathLike[str] = "data") -> Data:
    """The stored datasets that claims read; a group without a file is left out.

    Raises StoreError if a file that is there cannot be read.
    """
    return Data({path.stem: store.read(path) for path in _paths(folder) if path.exists()})


def _paths(folder: str | os.PathLike[str]) -> list[Path]:
    return [Path(folder) / f"{group}.nc" for group in GROUPS]


def evaluate(data: Data, claims: Sequence[Claim] = CLAIMS) -> list[Entry]:
    """The verdict on each claim."""
    return [judge(claim, data) for claim in claims]


def counts(verdicts: Sequence[Verdict]) -> dict[str, int]:
    """How many claims have each verdict."""
    return {key(verdict): sum(one == verdict for one in verdicts) for verdict in MEANINGS}


def sensitivity(data: Data, entries: Sequence[Entry]) -> list[dict[str, Any]]:
    """For each word with its bound halved and doubled: the counts, and the claims whose verdict changes.

    Only claims with a condition that names the word are judged again.
    """
    own = {entry.claim.id: entry for entry in entries if not entry.claim.beyond}
    verdicts = {name: entry.verdict for name, entry in own.items()}
    rows = []
    for word, factor in product(TABLE, FACTORS):
        changed = bounds(word.name, factor)
        now = {name: judge(one.claim, data, changed).verdict for name, one in own.items() if word.name in one.words}
        moved = {name: verdict for name, verdict in now.items() if verdict != verdicts[name]}
        rows.append(
            {
                "word": word.name,
                "bound": changed[word.name],
                "factor": factor,
                "counts": counts(list((verdicts | moved).values())),
                "changed": moved,
            }
        )
    return rows


def document(data: Data, entries: Sequence[Entry]) -> dict[str, Any]:
    """Everything about the verdicts, as it is stored.

    ``counts`` and ``robustness`` are scalars for ``dvc metrics show``, which passes over lists.
    """
    own = [entry for entry in entries if not entry.claim.beyond]
    degrees = [entry.robustness for entry in own]
    return {
        "counts": {
            **counts([entry.verdict for entry in own]),
            "total": len(own),
            "beyond": len(entries) - len(own),
        },
        "robustness": {key(kind): degrees.count(kind) for kind in ROBUSTNESS_MEANINGS},
        "verdict_kinds": [{"verdict": verdict, "meaning": meaning} for verdict, meaning in MEANINGS.items()],
        "robustness_kinds": [{"robustness": kind, "meaning": meaning} for kind, meaning in ROBUSTNESS_MEANINGS.items()],
        "changes": [{"change": change, "sentence": sentence} for change, sentence in CHANGES.items()],
        "words": [{"word": w.name, "bound": w.bound, "sentence": w.sentence} for w in TABLE],
        "sensitivity": sensitivity(data, entries),
        "sentences": sentences.looked_at(data),
        "table": [_row(entry) for entry in entries],
    }


def _row(entry: Entry) -> dict[str, Any]:
    claim, finding = entry.claim, entry.finding
    row: dict[str, Any] = {
        "id": claim.id,
        "place": claim.place,
        "measured": claim.measured,
        "paper": claim.paper,
        "verdict": entry.verdict,
        "reason": entry.reason,
        "robustness": entry.robustness,
        "robustness_reason": entry.robustness_reason,
        "figures": list(claim.figures),
        "group": claim.group,
        "beyond": claim.beyond,
        "ours": finding.summary if finding else "",
        "value": None,
        "interval": None,
        "interval_kind": "",
        "tests": [],
        "samples": None,
        "readings": [],
    }
    if finding:
        row.update(_interval(finding.quantity))
        asked = [c.found for reading in finding.interpretations for c in reading.conditions]
        row["tests"] = list(dict.fromkeys(one.tested for one in asked))
        row["samples"] = [min(one.samples for one in asked), max(one.samples for one in asked)]
        row["readings"] = [
            {
                "name": reading.name,
                "change": reading.change,
                "outcome": reading.outcome,
                "conditions": [
                    {
                        "measured": c.measured,
                        "asked": c.asked,
                        "outcome": c.outcome,
                        "words": list(c.words),
                        "test": c.found.tested,
                        "samples": c.found.samples,
                        **_interval(c.found),
                    }
                    for c in reading.conditions
                ],
            }
            for reading in finding.readings
        ]
    return row


def _interval(quantity: Quantity) -> dict[str, Any]:
    """A value with its interval and the kind of it; an end that is open is null."""
    bare = quantity.kind == "none"
    return {
        "value": rounded(quantity.value),
        "interval": None if bare else [rounded(quantity.low), rounded(quantity.high)],
        "interval_kind": KINDS[quantity.kind],
    }


def write(
    output: str | os.PathLike[str] = OUTPUT,
    folder: str | os.PathLike[str] = "data",
    keep: Sequence[str | os.PathLike[str]] = (),
) -> dict[str, Any]:
    """Judge all claims on the datasets in ``folder`` and store the result; returns it.

    Raises ClaimsError if there are none, StoreError if one cannot be read, OSError if the output cannot be written
    or is one of the datasets or of the files to ``keep``.
    """
    target = Path(output)
    atomic.check_output(target, [*_paths(folder), *keep])
    data = collect(folder)
    if not data.groups:
        raise ClaimsError(f"{folder}: holds none of the datasets that claims read; make them with dvc repro")
    found = document(data, evaluate(data))
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(target, (json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode())
    return found
