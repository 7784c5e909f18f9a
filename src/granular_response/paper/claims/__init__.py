"""The paper's claims against the stored datasets: a verdict for each, by rules that stand beside the claims.

``collect`` reads what is stored, ``evaluate`` judges, ``document`` makes the JSON that ``dvc metrics show``, the
report and the README quote.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from granular_response.store import atomic, generated
from granular_response.store import files as store

from . import disorder, fields, friction, frictionless, numerics
from .claim import VERDICTS, Claim, Data, Entry, Finding, NotMeasured, Verdict, judge

CLAIMS: tuple[Claim, ...] = (
    *frictionless.CLAIMS,
    *friction.CLAIMS,
    *fields.CLAIMS,
    *disorder.CLAIMS,
    *numerics.CLAIMS,
)

#: Figure groups whose datasets the claims read.
GROUPS: tuple[str, ...] = tuple(sorted({claim.group for claim in CLAIMS} | {friction.BREAKING}))

#: Where the table of claims is kept.
OUTPUT = Path("figures") / "claims.json"

#: Verdicts as they read after a number.
VERBS: dict[Verdict, str] = {
    "reproduced": "reproduced",
    "differs": "different in part",
    "not reproduced": "not reproduced",
    "not measured": "not measured",
}

#: Name of the generated lines in the README.
BLOCK = "claims"

__all__ = [
    "BLOCK", "CLAIMS", "GROUPS", "OUTPUT", "VERDICTS", "Claim", "ClaimsError", "Data", "Entry", "Finding",
    "NotMeasured", "Verdict", "collect", "counts", "document", "evaluate", "judge", "read", "renew", "sentence",
    "write",
]  # fmt: skip


class ClaimsError(Exception):
    """Nothing to judge, or no stored table. The message is one line."""


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


def counts(entries: Sequence[Entry]) -> dict[Verdict, int]:
    """How many claims have each verdict."""
    return {verdict: sum(entry.verdict == verdict for entry in entries) for verdict in VERDICTS}


def document(entries: Sequence[Entry]) -> dict[str, Any]:
    """Everything about the verdicts, as it is stored.

    ``counts`` and ``verdicts`` are scalars for ``dvc metrics show``, which passes over the list ``table``.
    """
    summary = {verdict.replace(" ", "_"): number for verdict, number in counts(entries).items()}
    verdicts = {
        entry.claim.id: {"verdict": entry.verdict, **({"value": _number(entry.finding.value)} if entry.finding else {})}
        for entry in entries
    }
    return {"counts": {**summary, "total": len(entries)}, "verdicts": verdicts, "table": [_row(e) for e in entries]}


def _row(entry: Entry) -> dict[str, Any]:
    claim, finding = entry.claim, entry.finding
    row: dict[str, Any] = {
        "id": claim.id,
        "place": claim.place,
        "measured": claim.measured,
        "paper": claim.paper,
        "verdict": entry.verdict,
        "reason": entry.reason,
        "figures": list(claim.figures),
        "group": claim.group,
        "ours": finding.summary if finding else "",
        "value": None,
        "interval": None,
        "rule": [],
    }
    if finding:
        row["value"] = _number(finding.value)
        row["interval"] = [_number(v) for v in finding.interval] if finding.interval else None
        row["rule"] = [
            {"text": c.text, "measured": c.measured, "holds": bool(c.holds), "essential": c.essential}
            for c in finding.conditions
        ]
    return row


def _number(value: float) -> float | None:
    """To six digits, so that the last ones of a machine do not show; None for nan, which JSON lacks."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


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
    found = document(evaluate(data))
    target.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_bytes(target, (json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode())
    return found


def read(path: str | os.PathLike[str] = OUTPUT) -> dict[str, Any]:
    """The stored table. Raises ClaimsError if it is missing or damaged."""
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ClaimsError(
            f"{path}: {getattr(error, 'strerror', None) or error}; make it with granular-response claims"
        ) from None
    if not isinstance(found, dict) or not {"counts", "table"} <= set(found):
        raise ClaimsError(f"{path}: is not a table of claims")
    return found


def sentence(found: dict[str, Any]) -> str:
    """The counts in words."""
    number = found["counts"]
    named = ((number[verdict.replace(" ", "_")], verdict) for verdict in VERDICTS)
    parts = [f"{n} {VERBS[verdict]}" for n, verdict in named if n]
    return f"Of {number['total']} claims of the paper: {', '.join(parts)}."


def renew(readme: str | os.PathLike[str], found: dict[str, Any]) -> None:
    """Renew the counts that a file quotes. Raises GeneratedError if it cannot be read or has no place for them."""
    generated.renew(readme, BLOCK, sentence(found))
