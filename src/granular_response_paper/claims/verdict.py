"""The verdict on a claim: one function of its readings, never written by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .claim import Claim, Data, Finding, NotMeasured, Outcome, Reading
from .words import Bounds, bounds

Verdict = Literal["reproduced", "depends on the reading", "undecided", "contradicted", "derivation", "not measured"]

#: Every verdict and what it says.
MEANINGS: dict[Verdict, str] = {
    "reproduced": "it holds with its uncertainty in every reading of the set-up that was measured",
    "depends on the reading": "it holds in one reading and fails in another",
    "undecided": "the uncertainty of a reading straddles the line",
    "contradicted": "it fails in all readings, clear of the uncertainty",
    "derivation": "algebra that no simulation can fail; it is counted apart",
    "not measured": "no stored dataset decides it; the reason says what would",
}


#: Conditions of a reading that a reason quotes; the table has all.
SHOWN = 2


@dataclass(frozen=True)
class Entry:
    """A claim with its verdict; ``reason`` says why in a sentence."""

    claim: Claim
    verdict: Verdict
    finding: Finding | None
    reason: str


def verdict_of(readings: Sequence[Reading], *, derivation: bool = False) -> Verdict:
    """Holds in all: reproduced, or a derivation; in some and fails in others: depends; fails in all: contradicted."""
    if not readings:
        raise ValueError("a finding needs readings")
    outcomes = {reading.outcome for reading in readings}
    if outcomes == {"holds"}:
        return "derivation" if derivation else "reproduced"
    if {"holds", "fails"} <= outcomes:
        return "depends on the reading"
    return "contradicted" if outcomes == {"fails"} else "undecided"


def judge(claim: Claim, data: Data, words: Bounds | None = None) -> Entry:
    """Measure a claim on stored data, with the words of the table or with others."""
    try:
        finding = claim.measure(data, bounds() if words is None else words)
        verdict = verdict_of(finding.readings, derivation=claim.derivation)
    except NotMeasured as missing:
        return Entry(claim, "not measured", None, str(missing))
    return Entry(claim, verdict, finding, _reason(finding, verdict))


def _reason(finding: Finding, verdict: Verdict) -> str:
    parts = []
    named = len(finding.readings) > 1
    titles: dict[Outcome, str] = {"holds": "Holds", "fails": "Fails", "open": "Open"}
    for outcome, title in titles.items():
        these = [reading for reading in finding.readings if reading.outcome == outcome]
        if these:
            parts.append(f"{title}: {'; '.join(_why(reading, outcome, named) for reading in these)}.")
    return " ".join([*parts, *([f"{finding.remark}."] if finding.remark else [])])


def _why(reading: Reading, outcome: Outcome, named: bool) -> str:
    """A reading that holds by its name, another one with the conditions that decide it."""
    telling = [c for c in reading.conditions if c.outcome == outcome]
    text = ", ".join(f"{c.measured} (asked: {c.asked})" for c in telling[:SHOWN])
    if len(telling) > SHOWN:
        text += f", and {len(telling) - SHOWN} more"
    if outcome == "holds" and named:
        return reading.name
    return f"{reading.name}: {text}" if named else text
