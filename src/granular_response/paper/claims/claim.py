"""What a claim of the paper is, and how its verdict follows from conditions on stored data.

A claim is measured by a function that reads datasets and returns a :class:`Finding`: numbers, and conditions that
they satisfy or not. The verdict follows from the conditions alone. Each condition states its tolerance, so
the rule stands beside the claim in the code and beside the verdict in the table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import xarray as xr

Verdict = Literal["reproduced", "differs", "not reproduced", "not measured"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "differs", "not reproduced", "not measured")

#: Labels are the same if they differ by less than this part of them.
_SAME = 1e-9


class NotMeasured(Exception):
    """A dataset or variable that a claim needs is not stored. The message names it."""


class Data:
    """Stored datasets by figure group; asking for what is not there raises NotMeasured.

    ``groups`` maps a figure group to its datasets by name, as ``store.read`` returns them.
    """

    def __init__(self, groups: Mapping[str, Mapping[str, xr.Dataset]]) -> None:
        self.groups = groups

    def get(self, group: str, name: str, *variables: str) -> xr.Dataset:
        """Dataset ``name`` of ``group`` with at least ``variables``."""
        if group not in self.groups:
            raise NotMeasured(f"data/{group}.nc is missing")
        if name not in self.groups[group]:
            raise NotMeasured(f"data/{group}.nc holds no dataset {name}")
        dataset = self.groups[group][name]
        missing = [variable for variable in variables if variable not in dataset.variables]
        if missing:
            raise NotMeasured(f"data/{group}.nc: {name} holds no {', '.join(missing)}")
        return dataset

    def event(self, group: str, name: str, friction: float | None = None, *, dataset: str = "events") -> Bracket:
        """The bracket of an event; ``friction`` None takes the first event of that name."""
        events = self.get(group, dataset, "name", "low", "high")
        at = events["name"].values == name
        if friction is not None and "friction" in events.variables:
            at = at & (np.abs(events["friction"].values - friction) <= _SAME * abs(friction))
        if not at.any():
            with_friction = "" if friction is None else f" at friction {friction:g}"
            raise NotMeasured(f"data/{group}.nc: {dataset} holds no {name}{with_friction}")
        k = int(np.flatnonzero(at)[0])
        return Bracket(float(events["low"].values[k]), float(events["high"].values[k]))


def at(dataset: xr.Dataset, **labels: float) -> xr.Dataset:
    """The entries at the given labels, up to rounding; NotMeasured if a label is not stored."""
    for name, label in labels.items():
        stored = np.asarray(dataset[name].values, dtype=float)
        near = np.flatnonzero(np.abs(stored - label) <= _SAME * abs(label))
        if not near.size:
            raise NotMeasured(f"nothing is stored at {name} = {label:g}")
        dataset = dataset.isel({name: int(near[0])})
    return dataset


@dataclass(frozen=True)
class Bracket:
    """An event happens above ``low`` and not above ``high``; ``high`` is nan if it does not happen up to ``low``."""

    low: float
    high: float

    @property
    def happens(self) -> bool:
        return bool(np.isfinite(self.high))

    @property
    def middle(self) -> float:
        return 0.5 * (self.low + self.high)

    def within(self, low: float, high: float) -> bool:
        """Whether the whole bracket lies in the closed interval."""
        return self.happens and low <= self.low and self.high <= high

    def text(self, unit: str = "") -> str:
        if not self.happens:
            return f"not up to {self.low:.4g}{unit}"
        return f"{self.low:.4g} to {self.high:.4g}{unit}"


@dataclass(frozen=True)
class Condition:
    """One thing a claim asks for: ``text`` says what, with its tolerance; ``measured`` what was found."""

    text: str
    holds: bool
    measured: str
    essential: bool = False  #: without it the claim is not reproduced, whatever else holds


@dataclass(frozen=True)
class Finding:
    """What was measured for a claim.

    ``summary`` is for readers; ``value`` the one number that stands for it; ``interval`` the bracket or interval
    it lies in; ``remark`` a reason known for a difference, shown if there is one.
    """

    summary: str
    value: float
    conditions: Sequence[Condition]
    interval: tuple[float, float] | None = None
    remark: str = ""


@dataclass(frozen=True)
class Claim:
    """A claim of the paper and how it is measured."""

    id: str
    place: str
    measured: str
    paper: str
    measure: Callable[[Data], Finding] = field(repr=False)
    figures: tuple[int, ...] = ()
    group: str = ""


@dataclass(frozen=True)
class Entry:
    """A claim with its verdict."""

    claim: Claim
    verdict: Verdict
    finding: Finding | None
    reason: str


def verdict_of(conditions: Sequence[Condition]) -> Verdict:
    """Reproduced if all hold; not reproduced if an essential one fails or none holds; differs otherwise."""
    held = [condition.holds for condition in conditions]
    if not conditions:
        raise ValueError("a finding needs conditions")
    if all(held):
        return "reproduced"
    if not any(held) or any(c.essential and not c.holds for c in conditions):
        return "not reproduced"
    return "differs"


def judge(claim: Claim, data: Data) -> Entry:
    """Measure a claim on stored data."""
    try:
        finding = claim.measure(data)
    except NotMeasured as missing:
        return Entry(claim, "not measured", None, str(missing))
    verdict = verdict_of(finding.conditions)
    failed = [f"{c.measured} (asked: {c.text})" for c in finding.conditions if not c.holds]
    reason = ". ".join(failed + ([finding.remark] if failed and finding.remark else []))
    return Entry(claim, verdict, finding, reason)


#: Tolerance on forces that the paper reads off its own simulations at some sampled forces.
SAMPLED = 0.2


def sampled_event(what: str, bracket: Bracket, paper: float, unit: str = " mg") -> list[Condition]:
    """Conditions on an event of which the paper gives the first sampled value at which it has happened."""
    low = (1.0 - SAMPLED) * paper
    text = f"from {low:.4g} to {paper:g}{unit} (the paper's first sampled value, or up to {SAMPLED:.0%} before it)"
    return [
        Condition(f"{what} happens", bracket.happens, f"{what}: {bracket.text(unit)}", essential=True),
        Condition(text, bracket.within(low, paper), f"{what}: {bracket.text(unit)}"),
    ]


def about_event(
    what: str, bracket: Bracket, paper: float, tolerance: float = SAMPLED, unit: str = " mg"
) -> list[Condition]:
    """Conditions on an event that the paper places at about a value."""
    low, high = (1.0 - tolerance) * paper, (1.0 + tolerance) * paper
    text = f"{what} within {tolerance:.0%} of {paper:g}{unit}"
    return [
        Condition(f"{what} happens", bracket.happens, f"{what}: {bracket.text(unit)}", essential=True),
        Condition(text, bracket.within(low, high), f"{what}: {bracket.text(unit)}"),
    ]
