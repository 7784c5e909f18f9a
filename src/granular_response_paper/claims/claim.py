"""A claim is a sentence with one primary test, which the text fixes; its tests are numbers against bounds.

Where the text leaves a parameter open, the test is made for each of its values (``case``), and tests with the same case
hold together. Tests in another preparation of the packing (``prepared``) decide nothing but the second column.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
import xarray as xr

from granular_response.errors import GranularError

from .words import THRESHOLDS

#: What an interval means: none (one deterministic run); the event lies inside; 95 % of the bootstrap draws; the
#: smallest to the largest value.
Kind = Literal["none", "bracket", "confidence", "range"]

Outcome = Literal["yes", "no", "cannot tell"]

#: The group whose events are those of other preparations.
PREPARATION = "preparation"


class ClaimsError(GranularError):
    """A claim that is not declared as it must be, nothing to judge, or no stored table. The message is one line."""


class NotMeasured(GranularError):
    """What a claim needs is not stored. The message names it."""


@dataclass(frozen=True)
class Quantity:
    """A number, the interval in which it lies and the kind of that interval; ``high`` is inf for a lower bound.

    ``method`` names the statistic behind the interval, ``samples`` the number of packings.
    """

    value: float
    low: float
    high: float
    kind: Kind = "none"
    method: str = field(default="", compare=False)
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
        """The ratio, with the interval that both intervals leave; both positive. NotMeasured if ``other`` is 0."""
        needs(other.high != 0.0, "nothing to compare with")
        kind: Kind = other.kind if self.kind == "none" else self.kind
        low = self.low / other.high
        high = self.high / other.low if other.low > 0.0 else float("inf")
        value = self.value / other.value if other.value else float("nan")
        return Quantity(value, low, high, kind, self.method or other.method, max(self.samples, other.samples))

    @property
    def happens(self) -> bool:
        return math.isfinite(self.high)

    def text(self, unit: str = "") -> str:
        """For readers; the ``unit`` "%" shows parts as per cent."""
        low, high = shown(self.low, unit), shown(self.high, unit)
        if self.kind == "none" or (self.happens and low == high):  # in as many digits as are shown
            return shown(self.value if math.isfinite(self.value) else self.low, unit)
        ends = f"{low} to {high}" if self.happens else f"above {low}"
        whole = self.kind != "bracket" and math.isfinite(self.value)
        return f"{shown(self.value, unit)} ({ends})" if whole else ends


def shown(value: float, unit: str) -> str:
    return f"{100.0 * value:.3g} %" if unit == "%" else f"{value:.4g}{' ' + unit if unit else ''}"


class Bound(NamedTuple):
    """What the text asks of a number: from ``least`` to ``most``, or with ``strict`` between them.

    ``word`` is the qualitative term whose threshold set it, if any did.
    """

    least: float = -math.inf
    most: float = math.inf
    word: str = ""
    strict: bool = False

    def outcome(self, found: Quantity) -> Outcome:
        """Yes with the whole interval inside, no with all of it outside, cannot tell otherwise."""
        low, high = found.low, found.high
        if self.strict:
            inside = self.least < low and (high < self.most or self.most == math.inf)
            outside = high <= self.least or low >= self.most
        else:
            inside = self.least <= low and high <= self.most
            outside = high < self.least or low > self.most
        return "yes" if inside else "no" if outside else "cannot tell"

    def text(self, unit: str = "") -> str:
        least, most = shown(self.least, unit), shown(self.most, unit)
        if not math.isfinite(self.most):
            return f"{'more than' if self.strict else 'at least'} {least}"
        if not math.isfinite(self.least):
            return f"{'less than' if self.strict else 'at most'} {most}"
        return least if self.least == self.most else f"{least} to {most}"


@dataclass(frozen=True)
class Test:
    """A number against a bound, for one value of what the text leaves open (``case``).

    ``prepared`` names the preparation if it is not the paper's.
    """

    what: str
    found: Quantity
    bound: Bound
    case: str = ""
    unit: str = ""
    prepared: str = ""

    __test__: ClassVar = False  # for pytest: no class of tests

    @property
    def outcome(self) -> Outcome:
        needs(not np.isnan([self.found.low, self.found.high]).any(), f"{self.what}: no number is stored")
        return self.bound.outcome(self.found)


class Case(NamedTuple):
    """A value of what the text leaves open, what its number is ``of``, and the preparation if not the paper's."""

    name: str = ""
    of: str = ""
    prepared: str = ""


#: What the function of a claim yields: for each case its name, or a :class:`Case`, and a number for each test.
Numbers = Iterator[tuple[Any, ...]]


@dataclass(frozen=True)
class Claim:
    """A sentence, where it stands, and the function that makes its tests from stored data.

    ``here`` is a sentence with the numbers of the first tests in braces; ``modal`` a sentence that says what may be, so
    that a failed test does not contradict it; ``derivation`` algebra that no simulation can fail; ``disorder`` a
    statement on disordered packings.
    """

    id: str
    place: str
    paper: str
    measured: str
    measure: Callable[[Data], Sequence[Test]] = field(repr=False)
    group: str = ""
    here: str = ""
    figures: Sequence[int] = ()
    source: Literal["paper", "literature", "hypothesis"] = "paper"  #: whose sentence it is
    modal: bool = False
    derivation: bool = False
    disorder: bool = False
    remark: str = ""

    @property
    def part(self) -> str:
        """The part of the table in which it stands: what goes beyond the paper is counted apart."""
        return "extension" if self.id.startswith("B") else "disorder" if self.disorder else "ordered"


@dataclass(frozen=True)
class Data:
    """Stored datasets by figure group and name, as ``store.read`` returns them; a missing one raises NotMeasured.

    ``words`` are the thresholds under which they are judged, ``prepared`` the labels of another preparation.
    """

    groups: Mapping[str, Mapping[str, xr.Dataset]]
    words: dict[str, float] = field(default_factory=lambda: THRESHOLDS)
    prepared: dict[str, Any] = field(default_factory=dict)

    def get(self, group: str, name: str) -> xr.Dataset:
        needs(group in self.groups, f"data/{group}.nc is missing")
        needs(name in self.groups[group], f"data/{group}.nc holds no dataset {name}")
        return self.groups[group][name]

    def event(self, group: str, name: str, **labels: Any) -> Quantity:
        """The bracket of an event, ``name`` or ``dataset.name`` if not of ``events``: the first with these labels.

        Without friction it is the same in every preparation: the equilibrium is one minimum, whatever came before.
        """
        table, _, name = name.rpartition(".")
        if self.prepared and labels["friction"] > 0.0:
            group, labels = PREPARATION, labels | self.prepared
        found = at(self.get(group, table or "events"), name=name, **labels)
        return Quantity.bracket(float(found["low"]), float(found["high"]))


def needs(there: object, what: str) -> None:
    """Raises NotMeasured, which says ``what`` is missing, unless ``there`` is true."""
    if not there:
        raise NotMeasured(what)


def at(dataset: xr.Dataset, **labels: float | str) -> xr.Dataset:
    """The first entry with all of the given labels, numbers to 1e-9 of them; raises NotMeasured if there is none.

    Labels may be of several coordinates along one dimension.
    """
    masks: dict[Hashable, np.ndarray] = {}
    for name, label in labels.items():
        (dimension,) = dataset[name].dims
        stored = dataset[name].values
        same = stored.astype(str) == label if isinstance(label, str) else np.isclose(stored, label, 1e-9, 0.0)
        masks[dimension] = masks.get(dimension, True) & same
        needs(masks[dimension].any(), f"nothing is stored at {name} = {label}")
    return dataset.isel({dimension: int(np.flatnonzero(mask)[0]) for dimension, mask in masks.items()})


def rise(values: Iterable[Quantity]) -> Quantity:
    """The smallest ratio of neighbours among positive ``values``; above 1 if each is larger than the one before."""
    steps = [after.per(before) for before, after in pairwise(values)]
    needs(steps, "fewer than two values to compare")
    value, low, high = (min(getattr(step, name) for step in steps) for name in ("value", "low", "high"))
    return Quantity(value, low, high, steps[0].kind)


def materials(study: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """The cases of a study, by polydispersity and friction."""
    for k in range(study.sizes["case"]):
        one = study.isel(case=k)
        yield f"polydispersity {float(one['polydispersity']):g}, friction {float(one['friction']):g}", one
