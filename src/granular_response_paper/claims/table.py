"""The paper's claims against the stored datasets: the table with a verdict for each, and how firm the counts are.

``collect`` reads what is stored, ``evaluate`` judges, ``document`` makes the JSON that ``dvc metrics show``, the
report and the README quote.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

from granular_response.store import atomic
from granular_response.store import files as store

from ..registry import PAPER, group_member
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
    return group_member(group, "claims", "CLAIMS", optional=True) or ()


#: All claims in the order of the table.
CLAIMS: tuple[Claim, ...] = tuple(sorted((claim for group in PAPER.groups for claim in _claims_of(group)), key=_place))

#: Figure groups whose datasets the claims read.
GROUPS: tuple[str, ...] = tuple(
    sorted({claim.group for claim in CLAIMS} | {preparations.GROUP, preparations.LOADING, sentences.MEANS})
)

#: How the bounds of words are changed to see how the counts move.
FACTORS = (0.5, 2.0)

#: Intervals as they are named for readers.
KINDS = {"bracket": "bracket", "confidence": "95 % confidence", "range": "range"}


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
        tally = counts(list((verdicts | now).values()))
        setting = {"word": word.name, "bound": changed[word.name], "factor": factor}
        rows.append(setting | {"counts": tally, "changed": moved})
    return rows


def document(data: Data, entries: Sequence[Entry]) -> dict[str, Any]:
    """Everything about the verdicts, as it is stored.

    ``counts`` and ``robustness`` are scalars for ``dvc metrics show``, which passes over lists.
    """
    own = [entry for entry in entries if not entry.claim.beyond]
    degrees = [entry.robustness for entry in own]
    return {
        "counts": counts([entry.verdict for entry in own]) | {"total": len(own), "beyond": len(entries) - len(own)},
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
    asked = [c.found for reading in finding.interpretations for c in reading.conditions] if finding else []
    samples = [one.samples for one in asked]
    return {
        **_named(claim, "id", "place", "measured", "paper"),
        **_named(entry, "verdict", "reason", "robustness", "robustness_reason"),
        **_named(claim, "figures", "group", "beyond"),
        "ours": finding.summary if finding else "",
        **_interval(finding.quantity if finding else None),
        "tests": list(dict.fromkeys(one.tested for one in asked)),
        "samples": [min(samples), max(samples)] if samples else None,
        "readings": [
            _named(reading, "name", "change", "outcome")
            | {
                "conditions": [
                    _named(c, "measured", "asked", "outcome", "words")
                    | {"test": c.found.tested, "samples": c.found.samples}
                    | _interval(c.found)
                    for c in reading.conditions
                ]
            }
            for reading in (finding.readings if finding else ())
        ],
    }


def _named(one: object, *names: str) -> dict[str, Any]:
    """Attributes by name, as JSON has them."""
    values = {name: getattr(one, name) for name in names}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


def _interval(quantity: Quantity | None) -> dict[str, Any]:
    """A value with its interval and the kind of it; null without them, and for an end that is open."""
    if quantity is None or quantity.kind == "none":
        return {"value": quantity and rounded(quantity.value), "interval": None, "interval_kind": ""}
    ends = [rounded(quantity.low), rounded(quantity.high)]
    return {"value": rounded(quantity.value), "interval": ends, "interval_kind": KINDS[quantity.kind]}


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
