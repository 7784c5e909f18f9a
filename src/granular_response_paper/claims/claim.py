"""What a claim of the paper is: stored numbers with their uncertainty, compared with bounds in one or more readings.

A claim is measured by a function that reads datasets and returns a :class:`Finding`: *readings*, which are
interpretations of the text or variants of its set-up, each with *conditions*, each a :class:`Quantity` against a bound.
:mod:`verdict` alone turns them into a verdict and a robustness.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import xarray as xr

from granular_response.errors import GranularError
from granular_response.scene import text as yaml

from ..registry import group_path
from .changes import CHANGES
from .words import Bounds

#: What an interval means: none (a number of one deterministic run); the event lies inside; 95 % of the bootstrap draws;
#: the smallest to the largest value.
Kind = Literal["none", "bracket", "confidence", "range"]

#: How a number is set against its bounds if nothing else is said, by the kind of its interval.
TESTS: dict[Kind, str] = {
    "none": "the number itself",
    "bracket": "both ends of the bracket",
    "confidence": "both ends of the 95 % interval",
    "range": "both ends of the range",
}

Outcome = Literal["holds", "fails", "open"]

#: Labels are the same if they differ by less than this part of them.
_SAME = 1e-9


class NotMeasured(GranularError):
    """What a claim needs is not stored. The message names it."""


@dataclass(frozen=True)
class Quantity:
    """A number, the interval it lies in, and what kind of interval that is; ``high`` is inf for a lower bound.

    ``test`` names the statistic behind the interval, ``samples`` how many packings it has.
    """

    value: float
    low: float
    high: float
    kind: Kind = "none"
    test: str = field(default="", compare=False)
    samples: int = field(default=1, compare=False)

    @classmethod
    def exact(cls, value: float) -> Quantity:
        return cls(float(value), float(value), float(value))

    @classmethod
    def bracket(cls, low: float, high: float) -> Quantity:
        """An event above ``low`` and not above ``high``; ``high`` nan means that it does not happen up to ``low``."""
        if math.isnan(high):
            return cls(float("nan"), float(low), float("inf"), "bracket")
        return cls(0.5 * float(low + high), float(low), float(high), "bracket")

    @classmethod
    def range(cls, values: Iterable[float], value: float | None = None) -> Quantity:
        found = [float(v) for v in values]
        return cls(found[0] if value is None else value, min(found), max(found), "range")

    def per(self, other: Quantity) -> Quantity:
        """The ratio, with the interval that both intervals leave; both positive. NotMeasured if that is 0."""
        if other.high == 0.0:
            raise NotMeasured("nothing to compare with")
        kind: Kind = other.kind if self.kind == "none" else self.kind
        low, high = self.low / other.high, self.high / other.low if other.low > 0.0 else float("inf")
        value = self.value / other.value if other.value else float("nan")
        return Quantity(value, low, high, kind, self.test or other.test, max(self.samples, other.samples))

    @property
    def tested(self) -> str:
        """How it is set against its bounds."""
        return self.test or TESTS[self.kind]

    @property
    def happens(self) -> bool:
        return math.isfinite(self.high)

    def text(self, unit: str = "") -> str:
        """For readers; ``unit`` "%" shows parts as per cent."""
        low, high = _number(self.low, unit), _number(self.high, unit)
        if self.kind == "none" or (self.happens and low == high):  # in as many digits as are shown
            return _number(self.value if math.isfinite(self.value) else self.low, unit)
        ends = f"{low} to {high}" if self.happens else f"above {low}"
        if self.kind == "bracket":
            return ends
        return f"{_number(self.value, unit)} ({ends})" if math.isfinite(self.value) else ends


def rounded(value: float) -> float | None:
    """As it is stored: to six digits, so that the last ones of a machine do not show; None for nan and inf, which JSON
    lacks."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _number(value: float, unit: str) -> str:
    return f"{100.0 * value:.3g} %" if unit == "%" else f"{value:.4g}{' ' + unit if unit else ''}"


@dataclass(frozen=True)
class Condition:
    """``found`` must lie from ``least`` to ``most``, or with ``strict`` between them.

    ``words`` are those of the table that set these bounds.
    """

    what: str
    found: Quantity
    least: float = -math.inf
    most: float = math.inf
    words: tuple[str, ...] = ()
    unit: str = ""
    strict: bool = False

    def __post_init__(self) -> None:
        if not (self.least > -math.inf or self.most < math.inf):
            raise ValueError(f"{self.what}: a condition needs a bound")

    @property
    def outcome(self) -> Outcome:
        """Holds with the whole interval inside the bounds, fails with all of it outside, open otherwise."""
        if math.isnan(self.found.low) or math.isnan(self.found.high):
            raise NotMeasured(f"{self.what}: no number is stored")
        low, high = self.found.low, self.found.high
        if self.strict:
            if self.least < low and (high < self.most or self.most == math.inf):
                return "holds"
            return "fails" if high <= self.least or low >= self.most else "open"
        if self.least <= low and high <= self.most:
            return "holds"
        return "fails" if high < self.least or low > self.most else "open"

    @property
    def asked(self) -> str:
        least, most = _number(self.least, self.unit), _number(self.most, self.unit)
        if not math.isfinite(self.most):
            return f"{'more than' if self.strict else 'at least'} {least}"
        if not math.isfinite(self.least):
            return f"{'less than' if self.strict else 'at most'} {most}"
        return least if self.least == self.most else f"{least} to {most}"

    @property
    def measured(self) -> str:
        return f"{self.what}: {self.found.text(self.unit)}"


@dataclass(frozen=True)
class Reading:
    """An interpretation of the paper's set-up or words, or a variant of its set-up, and what the claim asks for in it.

    ``change`` is what a variant changes, a key of :data:`~granular_response_paper.claims.changes.CHANGES`; an
    interpretation changes nothing. Raises ValueError without conditions, KeyError for another change.
    """

    name: str
    conditions: tuple[Condition, ...]
    change: str = ""

    def __init__(self, name: str, *conditions: Condition, change: str = "") -> None:
        if not conditions:
            raise ValueError(f"{name}: a reading needs conditions")
        if change and change not in CHANGES:
            raise KeyError(f"{name}: {change} is no change of the set-up")
        vars(self).update(name=name, conditions=conditions, change=change)

    @property
    def outcome(self) -> Outcome:
        outcomes = {condition.outcome for condition in self.conditions}
        return "fails" if "fails" in outcomes else "open" if "open" in outcomes else "holds"


@dataclass(frozen=True)
class Finding:
    """What was measured for a claim; the first reading is an interpretation, the one this project uses.

    ``summary`` is for readers; ``quantity`` the number that stands for the claim, by default that of the first
    condition over all interpretations; ``remark``, if it says numbers too, stands in place of the claim's own.
    """

    summary: str
    readings: Sequence[Reading]
    remark: str = ""

    @property
    def interpretations(self) -> list[Reading]:
        return [reading for reading in self.readings if not reading.change]

    @property
    def variants(self) -> list[Reading]:
        """In the order of the changes."""
        order = list(CHANGES)
        return sorted((r for r in self.readings if r.change), key=lambda reading: order.index(reading.change))

    @property
    def quantity(self) -> Quantity:
        """The first condition's number: its own interval, or the range over the interpretations that measure the
        same."""
        return range_over(self.interpretations)


def range_over(readings: Sequence[Reading]) -> Quantity:
    """The number of the first condition of the first reading; the range if others measure the same."""
    first = readings[0].conditions[0]
    same = [r.conditions[0].found for r in readings if r.conditions[0].what == first.what]
    if len(same) < 2:
        return first.found
    return Quantity(first.found.value, min(q.low for q in same), max(q.high for q in same), "range")


Measure = Callable[["Data", Bounds], Finding]


@dataclass(frozen=True)
class Claim:
    """A claim of the paper and how it is measured. A ``derivation`` is algebra that no simulation can fail.

    The ``remark`` is shown beside the verdict.
    """

    id: str
    place: str
    measured: str
    paper: str
    measure: Measure = field(repr=False)
    figures: tuple[int, ...] = ()
    group: str = ""
    derivation: bool = False
    remark: str = ""

    @property
    def beyond(self) -> bool:
        """Whether the paper leaves the question to words, so that it is counted apart."""
        return self.id.startswith("B")


#: Beside a group's ``claims.py``: what the paper says, by the number of the claim.
TEXTS = "claims.yaml"


class Claims(list[Claim]):
    """The claims of a figure group, each with the function that measures it.

    ``claims.yaml`` beside it has the ``place`` of each in the paper, the ``paper``'s words, what is ``measured``, the
    ``figures`` that show it unless they are those that the place names, a ``remark``, and whether it is a
    ``derivation``.
    """

    def __init__(self, group: str) -> None:
        self.group = group
        self._said = yaml.read((group_path(group) / TEXTS).read_text("utf-8"))

    def measures(self, id: str) -> Callable[[Measure], Measure]:
        """Said above the function that measures a claim. Raises KeyError if its text is missing."""
        said = {"figures": _figures(self._said[id]["place"]), **self._said[id]}

        def measured(measure: Measure) -> Measure:
            self.append(Claim(id, measure=measure, group=self.group, **said | {"figures": tuple(said["figures"])}))
            return measure

        return measured

    def needs(self, there: object, what: str) -> None:
        """Raises NotMeasured, which says ``what`` the group's datasets hold or lack, unless ``there`` is true."""
        if not there:
            raise NotMeasured(f"data/{self.group}.nc: {what}")


def _figures(place: str) -> tuple[int, ...]:
    """The figures in a place of the paper such as "V.F, Fig. 17e, f"."""
    named = "".join(re.findall(r"Figs?\. (.*)", place))
    return tuple(int(number) for number in re.findall(r"\d+", named))


class Data:
    """Stored datasets by figure group; asking for what is not there raises NotMeasured.

    ``groups`` maps a figure group to its datasets by name, as ``store.read`` returns them.
    """

    def __init__(self, groups: Mapping[str, Mapping[str, xr.Dataset]]) -> None:
        self.groups = groups

    def get(self, group: str, name: str) -> xr.Dataset:
        """Dataset ``name`` of ``group``."""
        if group not in self.groups:
            raise NotMeasured(f"data/{group}.nc is missing")
        if name not in self.groups[group]:
            raise NotMeasured(f"data/{group}.nc holds no dataset {name}")
        return self.groups[group][name]

    def event(self, group: str, name: str, friction: float | None = None) -> Quantity:
        """The bracket of an event; ``friction`` None takes the first event of that name."""
        events = self.get(group, "events")
        at = events["name"].values == name
        if friction is not None and "friction" in events.variables:
            at = at & (np.abs(events["friction"].values - friction) <= _SAME * abs(friction))
        if not at.any():
            with_friction = "" if friction is None else f" at friction {friction:g}"
            raise NotMeasured(f"data/{group}.nc: events holds no {name}{with_friction}")
        k = int(np.flatnonzero(at)[0])
        return Quantity.bracket(float(events["low"].values[k]), float(events["high"].values[k]))


def at(dataset: xr.Dataset, **labels: float) -> xr.Dataset:
    """The entries at the given labels, up to rounding; NotMeasured if a label is not stored."""
    for name, label in labels.items():
        stored = np.asarray(dataset[name].values, dtype=float)
        near = np.flatnonzero(np.abs(stored - label) <= _SAME * abs(label))
        if not near.size:
            raise NotMeasured(f"nothing is stored at {name} = {label:g}")
        dataset = dataset.isel({name: int(near[0])})
    return dataset
