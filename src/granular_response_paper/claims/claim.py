"""A claim is a function beside a sentence: what it yields are the numbers that the sentence is judged by.

One case, ``primary``, decides; the others say how far the sentence holds. docs/claims.md has an example, and what
function, docstring and decorator say.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr

from granular_response.errors import GranularError
from granular_response_paper import TOO_LITTLE

from .bounds import THRESHOLDS, Bound, Limits, Outcome, varied
from .numbers import NotMeasured, Quantity, needs, text

#: The group whose events are those of other preparations, and the study of what moves the events of ordered slabs.
PREPARATION, ROBUSTNESS = "preparation", "robustness"
#: How the names of cases from the initial lattice that the text names say so.
OF_THE_TEXT = "that of the text"
#: The group whose events both have.
ORDERED = "friction_linear_range"

Kind = Literal["supported", "not supported", "cannot tell", "not seen", "not measured"]


class ClaimsError(GranularError):
    """A claim that is not declared as it must be, nothing to judge, or no stored table. The message is one line."""


class Ask(NamedTuple):
    """What a number is, its bound and its unit; ``paper`` is the number that the paper prints for it."""

    what: str
    bound: Bound
    unit: str = ""
    paper: float | None = None


class Case(NamedTuple):
    """A case by its name; ``prepared`` is gravity or lattice if the packing is prepared in another way than the
    paper's.
    """

    name: str = ""
    prepared: Literal["", "gravity", "lattice"] = ""


#: What the function of a claim yields for each case: its name or a :class:`Case`, and the numbers.
Numbers = Iterator[Any]


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, or of whoever ``source`` says, and the function that measures it.

    ``here`` is our sentence, with {0}, {1} for numbers of the primary case, {case|1} for those of another one and
    {0:4} for four digits. It is written for the verdict ``finds`` or for any; else only the numbers are said. ``modal``
    marks a sentence that says what may be. Of the rows a statement is counted, a check can hardly fail.
    """

    id: str
    place: str
    paper: str
    asks: Sequence[Ask]
    measure: Callable[[Data], Numbers] = field(repr=False)
    short: str = ""
    here: str = ""
    group: str = ""
    requires: Mapping[str, Any] = field(default_factory=dict)
    primary: str = ""
    figures: Sequence[int] = ()
    source: Literal["paper", "literature", "hypothesis"] = "paper"
    row: Literal["statement", "check"] = "statement"
    modal: bool = False
    disorder: bool = False
    finds: Kind | Literal["any"] = "supported"
    remark: str = ""

    @property
    def part(self) -> str:
        """The part of the table in which it stands: what goes beyond the paper is counted apart."""
        return "extension" if self.id.startswith("B") else "disorder" if self.disorder else "ordered"


#: The paper's slab, for the claims of groups whose base scene it is.
SLAB = {
    "scene.packing.layers": 15,
    "scene.packing.disks_per_row": 61,
    "scene.contact.normal_stiffness": 3000.0,
    "scene.preparation.gravity": "at-once",
}


class Claims:
    """The claims of a figure group, in the order in which they are declared; ``requires`` are the paper's parameters.

    ``common`` is said of all of them.
    """

    def __init__(self, group: str, requires: Mapping[str, Any] | None = None, **common: Any) -> None:
        self.group, self.requires, self.common, self.rows = group, requires or {}, common, list[Claim]()

    def __call__(
        self, id: str, place: str, *asks: Ask, figures: Sequence[int] | None = None, requires: Any = None, **said: Any
    ) -> Callable[[Callable[[Data], Numbers]], Callable[[Data], Numbers]]:
        """Declare a claim by the function below and its docstring: the sentence, or "As R3a." for that of another claim
        of the group, then Short, Here and Remark. Figures are those of the place; ``requires`` are further parameters.
        """
        if figures is None:
            figures = [int(number) for number in re.findall(r"\d+", "".join(re.findall(r"Figs?\. (.*)", place)))]

        def declare(function: Callable[[Data], Numbers]) -> Callable[[Data], Numbers]:
            paper, *texts = re.split(r"\s+(?=(?:Short|Here|Remark): )", " ".join((function.__doc__ or "").split()))
            if other := re.fullmatch(r"As (\w+)\.", paper):
                paper = next(row.paper for row in self.rows if row.id == other[1])
            parts = {name.lower(): text for name, _, text in (one.partition(": ") for one in texts)}
            about: dict[str, Any] = {"group": self.group, "figures": figures, **self.common, **said, **parts}
            needed = {**self.requires, **(requires or {})}
            self.rows.append(Claim(id, place, paper, asks, function, requires=needed, **about))
            return function

        return declare


@dataclass(frozen=True)
class Data:
    """Stored datasets by figure group and name, with the parameters of each group; what is missing raises NotMeasured.

    ``words`` are the thresholds under which they are judged, ``prepared`` the labels of another preparation of ordered
    slabs, ``variant`` a change to the paper's slab or protocol of the study ``robustness``.
    """

    groups: Mapping[str, Mapping[str, xr.Dataset]]
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    words: Mapping[str, float] = field(default_factory=lambda: THRESHOLDS)
    prepared: Mapping[str, Any] = field(default_factory=dict)
    variant: str = ""

    def get(self, group: str, name: str) -> xr.Dataset:
        needs(group in self.groups, f"data/{group}.nc is missing")
        needs(name in self.groups[group], f"data/{group}.nc holds no dataset {name}")
        return self.groups[group][name]

    def value(self, group: str, name: str, over: Callable[..., Any] = np.asarray, **labels: Any) -> float:
        """One number, ``dataset.variable``, at the given labels; ``over`` reduces what dimensions are left."""
        dataset, _, variable = name.rpartition(".")
        study = self.get(group, dataset)
        values = np.asarray(over(study.variables[variable].isel(_first(study, labels), "ignore").values))
        needs(values.size == 1, f"{name}: {values.size} numbers in place of one")
        needs(np.isfinite(values).all(), f"{name}: no number is stored")
        return float(values.item())

    def event(self, name: str, friction: float, table: str = "events") -> Quantity:
        """The bracket of an event of the ordered slab; without friction it is the same whatever came before."""
        group: str = ORDERED
        labels: dict[str, Any] = {"name": name, "friction": friction}
        if self.variant:
            copy = friction == 0.0 and self.variant.startswith("displaced")
            group, labels["variant"] = ROBUSTNESS, "as in the paper" if copy else self.variant
        elif self.prepared and friction > 0.0:
            group, labels = PREPARATION, {**labels, **self.prepared}
        return self.bracket(group, table, **labels)

    def bracket(self, group: str, table: str, /, **labels: Any) -> Quantity:
        """That of the first event at the given labels in a dataset."""
        return self.brackets(group, table, **labels)[0]

    def brackets(self, group: str, table: str, /, **labels: Any) -> list[Quantity]:
        """Those of all events at the given labels; raises NotMeasured if there is none."""
        events = self.get(group, table)
        places = _places(events, labels)
        ends = (events.variables[end].isel(places).values.tolist() for end in ("low", "high"))
        return [Quantity.bracket(*one) for one in zip(*ends, strict=True)]

    def protocol(
        self, measure: Callable[[Data], Quantity], from_rest: str = "", friction: float = 0.0, *, dashpots: bool = True
    ) -> Quantity:
        """What is measured along the paper's load path, in the range over every protocol, or with the paper's dashpots.

        ``from_rest`` is an event whose forces by dynamics from rest to each force, with several ramps, belong to it.
        """
        others = (one for one in self.variants("protocol") if dashpots or not one.startswith("dashpots"))
        found = [measure(self), *(measure(replace(self, variant=name)) for name in others)]
        if from_rest:
            found += self.brackets(ROBUSTNESS, "events_from_rest", name=from_rest, friction=friction)
        return Quantity.over(found, "protocol", "range over the protocol")

    def variants(self, *kinds: str) -> list[str]:
        """The changes of these kinds in the study ``robustness``."""
        events = self.get(ROBUSTNESS, "events")
        there = np.isin(events["kind"].values.astype(str), kinds)
        names = dict.fromkeys(events["variant"].values.astype(str)[there].tolist())
        needs(names, f"robustness holds no change of the {' or the '.join(kinds)}")
        return list(names)

    def elsewhere(self, *measures: Callable[[Data], Quantity]) -> Numbers:
        """The same in slabs of other width and stiffness that have the events for it, and in other preparations, beside
        smooth walls and with the paper's dashpots.
        """
        changed = {Case(name): replace(self, variant=name) for name in self.variants("width", "stiffness")}
        if PREPARATION in self.groups:
            events = self.get(PREPARATION, "events")
            fixed = {"wall_friction": 0.0, "damping_ratio": float(events["damping_ratio"][0])}
            ways = set(zip(events["gravity"].values.tolist(), events["ramp_time"].values.tolist(), strict=True))
            for gravity, ramp in sorted(ways, key=lambda way: (way[0] != "slow", way[1])):
                name = "first without friction" if gravity == "frictionless" else f"ramped over {ramp:g} sqrt(R/g)"
                if gravity != "at-once":
                    prepared = {"gravity": gravity, "ramp_time": ramp} | fixed
                    changed[Case(f"gravity {name}", "gravity")] = replace(self, prepared=prepared)
        for case, data in changed.items():
            with suppress(NotMeasured):  # not every event is looked for in every slab
                yield case, *(measure(data) for measure in measures)


def at(dataset: xr.Dataset, **labels: float | str) -> xr.Dataset:
    """The first entry with all of the given labels, numbers to 1e-9 of them; raises NotMeasured if there is none.

    Labels may be of several coordinates along one dimension, or of a scalar, which must have that value.
    """
    return dataset.isel(_first(dataset, labels))


def _first(dataset: xr.Dataset, labels: Mapping[str, float | str]) -> dict[Hashable, int]:
    """Along each dimension, the first entry that has all of the labels."""
    return {dimension: found[0] for dimension, found in _places(dataset, labels).items()}


def _places(dataset: xr.Dataset, labels: Mapping[str, float | str]) -> dict[Hashable, list[int]]:
    """Along each dimension, which entries have all of the labels."""
    masks: dict[Hashable, np.ndarray] = {}
    for name, label in labels.items():
        needs(name in dataset.variables, f"{name} is not stored")
        variable = dataset.variables[name]
        stored = variable.values
        if isinstance(label, str):
            same = stored.astype(str) == label
        else:
            same = np.abs(stored - float(label)) <= 1e-9 * abs(label)
        if not variable.dims:
            needs(bool(same), f"is not stored at {name} = {label}")
            continue
        (dimension,) = variable.dims
        masks[dimension] = masks.get(dimension, True) & same
        needs(masks[dimension].any(), f"nothing is stored at {name} = {label}")
    return {dimension: np.flatnonzero(mask).tolist() for dimension, mask in masks.items()}


def rise(values: Iterable[Quantity]) -> Quantity:
    """The smallest ratio of neighbours among positive ``values``; above 1 if each is larger than the one before."""
    steps = [after.per(before) for before, after in pairwise(values)]
    needs(steps, "fewer than two values to compare")
    known = [step.value for step in steps if step.value is not None]
    low, high = (min(getattr(step, name) for step in steps) for name in ("low", "high"))
    return Quantity(min(known) if known else None, low, high, steps[0].kind)


def materials(study: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """The cases of a study, by polydispersity and friction."""
    for k in range(study.sizes["case"]):
        one = study.isel(case=k)
        yield f"polydispersity {float(one['polydispersity']):g}, friction {float(one['friction']):g}", one


@dataclass(frozen=True)
class Test:
    """A number of a case against its limits."""

    ask: Ask
    found: Quantity
    limits: Limits
    case: Case

    @property
    def outcome(self) -> Outcome:
        return self.limits.outcome(self.found)


def together(outcomes: Iterable[Outcome]) -> Outcome:
    """Of numbers that must all lie in their bounds."""
    found = set(outcomes)
    return "no" if "no" in found else "cannot tell" if "cannot tell" in found else "yes"


_NUMBER = re.compile(r"\{(?:(?P<case>[^{}|]+)\|)?(?P<place>\d+)(?::(?P<digits>\d))?\}")


@dataclass(frozen=True)
class Verdict:
    """On a claim, by its tests, or what is ``missing`` for them, so that there is no number.

    ``star`` names the qualitative terms on whose threshold it hangs.
    """

    claim: Claim
    tests: Sequence[Test] = ()
    missing: str = ""
    star: Sequence[str] = field(default_factory=list)

    @property
    def primary(self) -> list[Test]:
        return [test for test in self.tests if test.case == Case(self.claim.primary)]

    @property
    def verdict(self) -> Kind:
        if self.missing:
            return "not measured"
        outcome = together(test.outcome for test in self.primary)
        failed: Kind = "not seen" if self.claim.modal else "not supported"
        return {"yes": "supported", "no": failed, "cannot tell": "cannot tell"}[outcome]

    def others(self, prepared: str = "") -> dict[str, Outcome]:
        """The outcomes of the other cases, or of those that are ``prepared`` in another way."""
        found: dict[str, list[Outcome]] = {}
        for test in self.tests:
            if test.case.prepared == prepared and test.case != Case(self.claim.primary):
                found.setdefault(test.case.name, []).append(test.outcome)
        return {name: together(outcomes) for name, outcomes in found.items()}

    @property
    def here(self) -> str:
        """What was measured, in a sentence: the claim's own if it is written for this verdict, and all its numbers are
        there.
        """
        if self.missing:
            return self.missing

        def number(field: re.Match[str]) -> str:
            of = [test for test in self.tests if test.case.name == (field["case"] or self.claim.primary)]
            test = of[int(field["place"])]
            return text(test.found, test.ask.unit, int(field["digits"] or 0))

        with suppress(IndexError):
            if self.claim.finds in ("any", self.verdict):
                return _NUMBER.sub(number, self.claim.here)
        found = "; ".join(f"{test.ask.what}: {text(test.found, test.ask.unit)}" for test in self.primary)
        return f"{found[0].upper()}{found[1:]}."

    @property
    def cases(self) -> str:
        """For which other cases the sentence holds, fails or is open, in words."""
        found, titles = self.others(), {"yes": "For", "no": "Not for", "cannot tell": "Open for"}
        named = {title: [name for name, one in found.items() if one == outcome] for outcome, title in titles.items()}
        return " ".join(f"{title}: {'; '.join(some)}." for title, some in named.items() if some)


def tests(claim: Claim, data: Data) -> list[Test]:
    """Every number of a claim against its bound.

    Raises NotMeasured, for data of other parameters than the sentence is about too, and ClaimsError for another number
    of numbers.
    """
    for key, asked in claim.requires.items():
        needs(claim.group in data.groups, f"data/{claim.group}.nc is missing")
        stored = data.parameters.get(claim.group, {})
        needs(key in stored, f"data/{claim.group}.nc does not say its {key}")
        wanted, there = (of if isinstance(of, (list, tuple)) else [of] for of in (asked, stored[key]))
        same = all(one in there for one in wanted)
        needs(same, f"the sentence is about {key} = {asked}; data/{claim.group}.nc has {stored[key]}")
    limits = [ask.bound.limits(data.words) for ask in claim.asks]
    found = []
    with np.errstate(divide="ignore", invalid="ignore"):  # divisions by 0 give no number, which no quantity can be
        yielded = list(claim.measure(data))
    for one in yielded:
        row = one if isinstance(one, tuple) else (one,)
        case, *numbers = row if isinstance(row[0], (str, Case)) else ("", *row)
        case = Case(case) if isinstance(case, str) else case
        if len(numbers) != len(claim.asks):
            raise ClaimsError(f"{claim.group}: {claim.id}: {len(numbers)} numbers for {len(claim.asks)} bounds")
        for ask, limit, number in zip(claim.asks, limits, numbers, strict=True):
            if number is not None:  # not asked of this case
                number, limit_here = number if isinstance(number, tuple) else (number, limit)
                quantity = number if isinstance(number, Quantity) else Quantity.exact(number)
                found.append(Test(ask, quantity, limit_here, case))
    needs(any(test.case == Case(claim.primary) for test in found), f"the primary case {claim.primary} is not stored")
    return found


def judge(claim: Claim, data: Data) -> Verdict:
    """Make the tests of a claim on stored data.

    It is not measured if its function finds too little: a variable, a label, or all that is left to look at is missing.
    """

    def under(word: str, threshold: float) -> Kind:
        changed = dict(data.words) | {word: threshold}
        return Verdict(claim, tests(claim, replace(data, words=changed))).verdict

    try:
        found = Verdict(claim, tests(claim, data))
        used = sorted({test.ask.bound.word for test in found.primary if test.ask.bound.word})
        star = [word for word in used if {under(word, other) for other in varied(data.words[word])} != {found.verdict}]
        return replace(found, star=star)
    except NotMeasured as lacking:
        named = str(lacking).startswith(("data/", "the sentence"))
        return Verdict(claim, missing=str(lacking) if named else f"data/{claim.group}.nc: {lacking}")
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        return Verdict(claim, missing=f"data/{claim.group}.nc holds too little ({problem})")
