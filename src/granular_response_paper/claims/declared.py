"""Claims that ``claims.yaml`` declares: the number, the bound, and the cases of what the text leaves open.

A test has one of

``event``
    the name of an event in the group's dataset ``events`` (or in ``table``, or of another ``group``); with
    a ``friction`` and other labels ``at``, and ``prepared: true`` if the same event in other preparations makes the
    second column, or ``prepared: only`` if nothing else is looked at;
``value``
    ``dataset.variable``, at the labels ``at`` or where coordinates lie in ``where``; ``over`` reduces what is left,
    dimension by dimension (``max``, ``min``, ``average``, ``first``, ``last``, or ``interval`` with the stored ends);
    with ``unlike``, another one, their largest difference per its largest value;
``trend``
    the same, smallest ratio of neighbours along the dimension ``along`` (``falling: true`` turns it round);

and may have ``per``, a number of the same kind by which it is divided, ``scale`` and ``case`` (a value of what the text
leaves open). What else is measured has a function in the group's ``claims.py``, which ``numbers`` of the claim names,
with its arguments if it has some. It is called with the data and yields for each case its name (a text or a
:class:`Case`) and a number for each of the claim's tests, None for none, or with its bound where the data say it.

Every other test has a ``bound``, see :func:`bound`, and may have a ``unit`` and say ``what`` is measured, with ``{}``
for what a :class:`Case` is of. A claim may say what is ``missing`` in place of tests.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib import import_module, resources
from typing import Any

import numpy as np
import xarray as xr

from granular_response.scene import text as yaml

from . import preparations
from .bootstrap import RARE
from .claim import Bound, Case, Claim, Data, NotMeasured, Numbers, Quantity, Test, at, needs, rise
from .stored import ClaimsError
from .words import WORDS, Words

#: Beside a group's ``claims.py``.
TEXTS = "claims.yaml"

_KINDS = ("event", "value", "trend")
_KEYS = {*_KINDS, "table", "friction", "prepared", "at", "where", "over", "along", "falling", "per", "scale", "unit"}
_KEYS |= {"case", "bound", "what", "group", "unlike"}

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


_SIMPLE: dict[str, Callable[..., Any]] = {"max": np.max, "min": np.min, "average": np.mean}


def bound(what: Mapping[str, Any], words: Words) -> Bound:
    """The bound of a test, with a number or the threshold t of a qualitative term.

    ``about: 20`` (or another term) is off 20 by t of it at most; ``sampled: 20`` that the force 20 is the first sampled
    one at or above the event; ``lower by``, ``higher by`` and ``hardly lower by`` compare a ratio with 1 -+ t; ``same
    size`` asks for one from 1 / (1 + t) to 1 + t, ``order of magnitude`` for 10 on the logarithmic scale. The others
    say what they are, and ``rare`` is one in forty. ``times`` and ``plus`` scale and shift both ends, ``word`` names
    the term on which a number hangs. Raises ClaimsError for another key.
    """
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
    """The claims of a figure group, by its ``package``.

    ``claims.yaml`` has of each the ``place`` in the paper, the ``paper``'s sentence, what is ``measured``, and if they
    are not the usual: ``here``, ``figures`` (those that the place names), ``source``, ``modal``, ``derivation``,
    ``disorder``, ``remark``; and its ``test`` or ``tests``. Raises ClaimsError for a test that is not declared as it
    must be.
    """
    group, found = package.rpartition(".")[2], []
    for id, said in yaml.read(resources.files(package).joinpath(TEXTS).read_text("utf-8")).items():
        tests = [said.pop("test")] if "test" in said else said.pop("tests", [])
        numbers = said.pop("numbers", None)
        for one in tests:
            _check(f"{group}: {id}", one, declares=not numbers)
        rows: Callable[[Data], Numbers] = partial(_rows, group, tests)
        if numbers:
            ((name, given),) = numbers.items() if isinstance(numbers, dict) else [(numbers, {})]
            function = getattr(import_module(f"{package}.claims"), name, None)
            if function is None:
                raise ClaimsError(f"{group}: {id}: numbers: {name}, must be a function of the group's claims.py")
            rows = partial(function, **given)
        missing = said.pop("missing", None)
        measure = partial(_missing, missing) if missing else partial(_measured, group, said["measured"], tests, rows)
        figures = tuple(said.pop("figures", _figures(said["place"])))
        found.append(Claim(id, measure=measure, group=group, figures=figures, **said))
    return found


def _figures(place: str) -> tuple[int, ...]:
    """The figures in a place of the paper such as "V.F, Fig. 17e, f"."""
    return tuple(int(number) for number in re.findall(r"\d+", "".join(re.findall(r"Figs?\. (.*)", place))))


def _check(name: str, test: Mapping[str, Any], declares: bool = True) -> None:
    if unknown := set(test) - _KEYS:
        raise ClaimsError(f"{name}: unknown key {', '.join(sorted(unknown))}, must be of {', '.join(sorted(_KEYS))}")
    if sum(kind in test for kind in _KINDS) != declares:
        raise ClaimsError(f"{name}: a test needs one of {', '.join(_KINDS)}, or its claim the numbers of a function")


def _measured(
    group: str,
    what: str,
    tests: Sequence[Mapping[str, Any]],
    rows: Callable[[Data], Numbers],
    data: Data,
) -> list[Test]:
    found = []
    try:
        for case, *numbers in rows(data):
            for spec, number in zip(tests, numbers, strict=True):
                if number is None:
                    continue
                number, asked = number if isinstance(number, tuple) else (number, bound(spec["bound"], data.words))
                of, prepared = (case.of, case.prepared) if isinstance(case, Case) else ("", "")
                name = spec.get("what", what).replace("{}", of)
                number = number if isinstance(number, Quantity) else Quantity.exact(number)
                found.append(Test(name, number, asked, str(case), spec.get("unit", ""), prepared))
    except NotMeasured as lacking:
        named = str(lacking).startswith("data/")
        raise NotMeasured(str(lacking) if named else f"data/{group}.nc: {lacking}") from None
    return found


def _missing(what: str, data: Data) -> list[Test]:
    raise NotMeasured(what)


def _rows(group: str, tests: Sequence[Mapping[str, Any]], data: Data) -> Numbers:
    """What declared tests measure: each one's number by itself, and the event's in other preparations."""
    for k, spec in enumerate(tests):
        before, after = [None] * k, [None] * (len(tests) - k - 1)
        if spec.get("prepared") != "only":
            yield spec.get("case", ""), *before, _number(group, spec, data), *after
        if "prepared" in spec:
            frictions = [one["friction"] for one in (spec, spec.get("per")) if one]
            own = {frictions[-1]: _number(group, spec["per"], data)} if "per" in spec else {}
            for way, ends in preparations.along(data, spec["event"], frictions, own):
                yield way, *before, ends[0].per(ends[1]) if "per" in spec else ends[0], *after


def _number(group: str, spec: Mapping[str, Any], data: Data) -> Quantity:
    if "event" in spec:
        labels = {name: spec[name] for name in ("friction", "table") if name in spec} | spec.get("at", {})
        found = data.event(spec.get("group", group), spec["event"], **labels)
    elif "trend" in spec:
        values = _selected(group, spec, spec["trend"], data).sortby(spec["along"])
        along = [_reduced(values.isel({spec["along"]: k}), spec) for k in range(values.sizes[spec["along"]])]
        found = rise(along[::-1] if spec.get("falling") else along)
    else:
        values = _selected(group, spec, spec["value"], data)
        if "unlike" in spec:
            other = _selected(group, spec["unlike"], spec["unlike"]["value"], data)
            values = np.abs(values.drop_vars(values.coords) - other.drop_vars(other.coords)).max() / other.max()
        found = _reduced(values, spec)
    if "per" in spec:
        found = found.per(_number(group, spec["per"], data))
    scale = float(spec.get("scale", 1.0))
    return replace(found, value=scale * found.value, low=scale * found.low, high=scale * found.high)


def _where(study: xr.Dataset, spec: Mapping[str, Any]) -> xr.Dataset:
    for name, (low, high) in spec.get("where", {}).items():
        inside = (study[name].values >= low) & (study[name].values <= high)
        study = study.isel({study[name].dims[0]: inside})
    return study


def _selected(group: str, spec: Mapping[str, Any], source: str, data: Data) -> xr.DataArray:
    name, _, variable = source.rpartition(".")
    return at(_where(data.get(spec.get("group", group), name), spec), **spec.get("at", {}))[variable]


def _reduced(values: xr.DataArray, spec: Mapping[str, Any]) -> Quantity:
    for dimension, how in spec.get("over", {}).items():
        if how == "interval":
            value, low, high = values.values.tolist()
            return Quantity(value, low, high, "confidence", "bootstrap of the mean")
        if how in ("first", "last"):
            values = values.isel({dimension: 0 if how == "first" else -1})
        elif how in _SIMPLE:
            values = values.reduce(_SIMPLE[how], dimension)
        else:
            raise ClaimsError(f"over {dimension}: {how}, must be first, last, interval, {', '.join(_SIMPLE)}")
    needs(values.size == 1, f"{values.name}: {values.size} numbers in place of one")
    return Quantity.exact(float(values.values.reshape(-1)[0]))
