"""Claims that ``claims.yaml`` declares. What can be declared, and what it means, is in docs/extending.md."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module, resources
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from granular_response.scene import text as yaml

from . import preparations
from .bootstrap import RARE, over_realizations
from .claim import Bound, Case, Claim, ClaimsError, Data, NotMeasured, Numbers, Quantity, Test, at, needs, rise
from .words import WORDS

#: Beside a group's ``claims.py``.
TEXTS = "claims.yaml"

_KEYS = {"event", "value", "at", "where", "over", "rises", "falls", "unlike", "per", "group", "case", "prepared"}
_KEYS |= {"what", "unit", "bound"}

#: By the kind of a bound: its ends, from its number v and the threshold t of its term.
_ENDS: dict[str, Callable[[Any, float], Sequence[float]]] = {
    "sampled": lambda v, t: ((1.0 - t) * v, v),
    "between": lambda v, t: v,
    "at most": lambda v, t: (-math.inf, v),
    "less than": lambda v, t: (-math.inf, v),
    "at least": lambda v, t: (v, math.inf),
    "more than": lambda v, t: (v, math.inf),
    "lower by": lambda v, t: (-math.inf, 1.0 - t),
    "hardly lower by": lambda v, t: (1.0 - t, math.inf),
    "higher by": lambda v, t: (1.0 + t, math.inf),
    "same size": lambda v, t: (1.0 / (1.0 + t), 1.0 + t),
    "order of magnitude": lambda v, t: (10.0 ** (1.0 - t), 10.0 ** (1.0 + t)),
}
_ENDS |= dict.fromkeys(WORDS, lambda v, t: ((1.0 - t) * v, (1.0 + t) * v))

#: How ``over`` reduces a dimension.
_OVER: dict[str, Callable[..., Any]] = {"max": np.max, "min": np.min, "average": np.mean}
_OVER |= {"first": partial(np.take, indices=0), "last": partial(np.take, indices=-1)}


def bound(what: Mapping[str, Any], words: Mapping[str, float]) -> Bound:
    """The bound of a test, with a number or the threshold of a term. Raises ClaimsError for another key."""
    (kind, of), *_ = what.items()
    if kind not in _ENDS:
        raise ClaimsError(f"bound {kind}: must be one of {', '.join(_ENDS)}")
    of = RARE if of == "rare" else of
    word = of if isinstance(of, str) else kind if kind in WORDS else "about" if kind == "sampled" else ""
    t = words[word] if word else 0.0
    ends = _ENDS[kind](t if isinstance(of, str) else of, t)
    least, most = (float(end) * what.get("times", 1.0) + what.get("plus", 0.0) for end in ends)
    return Bound(least, most, what.get("word", word), strict=kind in ("less than", "more than"))


def read(package: str) -> list[Claim]:
    """The claims of a figure group, by its ``package``. Raises ClaimsError for one that is not declared rightly."""
    texts = yaml.read(resources.files(package).joinpath(TEXTS).read_text("utf-8"))
    return [_claim(package, id, said) for id, said in texts.items()]


def _claim(package: str, id: str, said: dict[str, Any]) -> Claim:
    group = package.rpartition(".")[2]
    tests = [said.pop("test")] if "test" in said else said.pop("tests", [])
    numbers, each, missing = (said.pop(key, none) for key, none in (("numbers", {}), ("each", {}), ("missing", "")))
    for one in tests:
        if unknown := sorted(set(one) - _KEYS):
            raise ClaimsError(f"{group}: {id}: unknown key {unknown[0]}, must be of {', '.join(sorted(_KEYS))}")
        if ("event" in one) + ("value" in one) != (not numbers):
            raise ClaimsError(f"{group}: {id}: a test needs event or value, or its claim the numbers of a function")
    rows = partial(_declared, group, tests, each)
    for name, given in (numbers if isinstance(numbers, dict) else {numbers: {}}).items():
        function = getattr(import_module(f"{package}.claims"), name, None)
        if function is None:
            raise ClaimsError(f"{group}: {id}: numbers: {name}, must be a function of the group's claims.py")
        rows = partial(_of_function, tests, partial(function, **given))

    def measure(data: Data) -> list[Test]:
        needs(not missing, missing)
        try:
            return [_test(said["measured"], data, *row) for row in rows(data)]
        except NotMeasured as lacking:
            named = str(lacking).startswith("data/")
            raise NotMeasured(str(lacking) if named else f"data/{group}.nc: {lacking}") from None

    named = re.findall(r"\d+", "".join(re.findall(r"Figs?\. (.*)", said["place"])))  # as in V.F, Fig. 17e, f
    figures = [int(number) for number in said.pop("figures", named)]
    return Claim(id, measure=measure, group=group, figures=figures, **said)


def _test(measured: str, data: Data, spec: Mapping[str, Any], case: str | Case, number: Any) -> Test:
    case = Case(case) if isinstance(case, str) else case
    number, asked = number if isinstance(number, tuple) else (number, bound(spec["bound"], data.words))
    found = number if isinstance(number, Quantity) else Quantity.exact(number)
    what = spec.get("what", measured).replace("{}", case.of)
    return Test(what, found, asked, case.name, spec.get("unit", ""), case.prepared)


def _of_function(tests: Sequence[Mapping[str, Any]], function: Callable[[Data], Numbers], data: Data) -> Numbers:
    """Each test with a case and its number there, as the function of the claim yields them."""
    for case, *numbers in function(data):
        for spec, number in zip(tests, numbers, strict=True):
            if number is not None:
                yield spec, case, number


def _declared(group: str, tests: Sequence[dict[str, Any]], each: dict[str, Any], data: Data) -> Numbers:
    """The same of declared tests: each one's number, and that in other preparations."""
    for labels, spec in product(product(*each.values()), tests):
        here = dict(zip(each, labels, strict=True))
        said = {name: each[name][one] if isinstance(each[name], dict) else one for name, one in here.items()}
        texts = {key: spec[key].format(**said) for key in ("case", "what") if here and key in spec}
        spec = spec | texts | {"at": spec.get("at", {}) | here}
        if spec.get("prepared") != "only":
            yield spec, spec.get("case", ""), _number(group, spec, data)
        if "prepared" in spec:
            yield from ((spec, *found) for found in preparations.along(data, partial(_number, group, spec)))


def _number(group: str, spec: Mapping[str, Any], data: Data) -> Quantity:
    if "event" in spec:
        found = data.event(spec.get("group", group), spec["event"], **spec.get("at", {}))
    else:
        values = _selected(group, spec, data)
        if "unlike" in spec:
            other = _selected(group, spec["unlike"], data)
            values = np.abs(values.drop_vars(values.coords) - other.drop_vars(other.coords)).max() / other.max()
        if along := spec.get("rises") or spec.get("falls"):
            values = values.sortby(along, ascending="rises" in spec)
            found = rise(_reduced(values.isel({along: k}), spec) for k in range(values.sizes[along]))
        else:
            found = _reduced(values, spec)
    if per := spec.get("per"):
        found = found.per(_number(group, per, data) if isinstance(per, dict) else Quantity.exact(per))
    return found


def _selected(group: str, spec: Mapping[str, Any], data: Data) -> xr.DataArray:
    name, _, variable = spec["value"].rpartition(".")
    study = data.get(spec.get("group", group), name)
    for label, (low, high) in spec.get("where", {}).items():
        study = study.isel({study[label].dims[0]: (study[label].values >= low) & (study[label].values <= high)})
    return at(study, **spec.get("at", {}))[variable]


def _reduced(values: xr.DataArray, spec: Mapping[str, Any]) -> Quantity:
    for dimension, how in spec.get("over", {}).items():
        if how == "interval":
            value, low, high = values.values.tolist()
            return Quantity(value, low, high, "confidence", "bootstrap of the mean")
        if how in ("bootstrap", "range"):
            return over_realizations(values, np.mean) if how == "bootstrap" else Quantity.range(values.values)
        if how not in _OVER:
            raise ClaimsError(f"over {dimension}: {how}, must be interval, bootstrap, range, {', '.join(_OVER)}")
        values = values.reduce(_OVER[how], dimension)
    needs(values.size == 1, f"{values.name}: {values.size} numbers in place of one")
    return Quantity.exact(values.item())
