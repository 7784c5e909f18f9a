"""The verdict on a claim and its robustness: functions of its readings, never written by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from .. import TOO_LITTLE
from .claim import Claim, Data, Finding, NotMeasured, Outcome, Reading, range_over
from .words import Bounds, bounds

Verdict = Literal[
    "reproduced", "depends on the interpretation", "undecided", "contradicted", "derivation", "not measured"
]
Robustness = Literal["robust", "breaks", "open", "not varied"]

#: Every verdict and what it says.
MEANINGS: dict[Verdict, str] = {
    "reproduced": "in the paper's set-up it holds with its uncertainty in every interpretation that was measured",
    "depends on the interpretation": "it holds in one interpretation of the text and fails in another",
    "undecided": "the uncertainty of an interpretation straddles the line",
    "contradicted": "it fails in all interpretations, clear of the uncertainty",
    "derivation": "algebra that no simulation can fail; it is counted apart",
    "not measured": "no stored dataset decides it; the reason says what would",
}


#: Every robustness and what it says.
ROBUSTNESS_MEANINGS: dict[Robustness, str] = {
    "robust": "it holds in every variant of the set-up that was measured",
    "breaks": "it fails in a variant",
    "open": "the uncertainty of a variant straddles the line",
    "not varied": "no other set-up was measured",
}


def key(kind: str) -> str:
    """Of a verdict or a robustness in the stored table."""
    return kind.replace(" ", "_")


#: Conditions of a reading that a reason quotes; the table has all.
SHOWN = 2


@dataclass(frozen=True)
class Entry:
    """A claim with its verdict and its robustness; ``reason`` and ``robustness_reason`` say why in a sentence."""

    claim: Claim
    verdict: Verdict
    finding: Finding | None
    reason: str
    robustness: Robustness = "not varied"
    robustness_reason: str = ""

    @property
    def words(self) -> set[str]:
        """Those that set a bound of one of its conditions."""
        readings = self.finding.readings if self.finding else ()
        return {word for reading in readings for condition in reading.conditions for word in condition.words}


def verdict_of(readings: Sequence[Reading], *, derivation: bool = False) -> Verdict:
    """Of the interpretations. Holds in all: reproduced, or a derivation; in some and fails in others: depends; fails in
    all: contradicted. Raises ValueError if there are none."""
    outcomes = {reading.outcome for reading in readings if not reading.change}
    if not outcomes:
        raise ValueError("a finding needs an interpretation of the text")
    if outcomes == {"holds"}:
        return "derivation" if derivation else "reproduced"
    if {"holds", "fails"} <= outcomes:
        return "depends on the interpretation"
    return "contradicted" if outcomes == {"fails"} else "undecided"


def robustness_of(readings: Sequence[Reading]) -> Robustness:
    """Of the variants."""
    outcomes = {reading.outcome for reading in readings if reading.change}
    if not outcomes:
        return "not varied"
    return "breaks" if "fails" in outcomes else "open" if "open" in outcomes else "robust"


def judge(claim: Claim, data: Data, words: Bounds | None = None) -> Entry:
    """Measure a claim on stored data, with the words of the table or with others.

    It is not measured if its function finds too little: a variable, a label, or all that is left to look at is missing.
    """
    try:
        finding = claim.measure(data, bounds() if words is None else words)
        verdict = verdict_of(finding.readings, derivation=claim.derivation)
    except NotMeasured as missing:
        return Entry(claim, "not measured", None, str(missing))
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        return Entry(claim, "not measured", None, f"data/{claim.group}.nc: holds too little ({problem})")
    return Entry(
        claim, verdict, finding, _reason(claim, finding), robustness_of(finding.readings), _robustness_reason(finding)
    )


def _robustness_reason(finding: Finding) -> str:
    """In how many variants it holds, over which range, and what breaks it first."""
    variants = finding.variants
    if not variants:
        return ""
    first, span = variants[0].conditions[0], range_over(variants)
    if span.kind == "range":
        span = replace(span, value=math.nan)  # shown as its ends
    holding = sum(variant.outcome == "holds" for variant in variants)
    text = f"Holds in {holding} of {len(variants)}; {first.what}: {span.text(first.unit)}."
    for outcome, title in (("fails", "Breaks first with"), ("open", "Open with")):
        these = [variant for variant in variants if variant.outcome == outcome]
        if these:
            return f"{text} {title} another {these[0].change}: {_why(these[0], these[0].outcome, True)}."
    return text


def _reason(claim: Claim, finding: Finding) -> str:
    parts = []
    interpretations = finding.interpretations
    named = len(interpretations) > 1
    titles: dict[Outcome, str] = {"holds": "Holds", "fails": "Fails", "open": "Open"}
    for outcome, title in titles.items():
        these = [reading for reading in interpretations if reading.outcome == outcome]
        if these:
            parts.append(f"{title}: {'; '.join(_why(reading, outcome, named) for reading in these)}.")
    remark = finding.remark or claim.remark
    return " ".join([*parts, *([f"{remark}."] if remark else [])])


def _why(reading: Reading, outcome: Outcome, named: bool) -> str:
    """A reading that holds by its name, another one with the conditions that decide it."""
    telling = [c for c in reading.conditions if c.outcome == outcome]
    text = ", ".join(f"{c.measured} (asked: {c.asked})" for c in telling[:SHOWN])
    if len(telling) > SHOWN:
        text += f", and {len(telling) - SHOWN} more"
    if outcome == "holds" and named:
        return reading.name
    return f"{reading.name}: {text}" if named else text
