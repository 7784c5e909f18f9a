"""Claims that ``claims.yaml`` declares: the number, the bound, and the cases of what the text leaves open.

A test has one of

``event``
    the name of an event in the group's dataset ``events`` (or in ``table``, or of another ``group``); with
    a ``friction``, and ``prepared: true`` if the same event in other preparations makes the second column;
``value``
    ``dataset.variable``, at the labels ``at`` or where coordinates lie in ``where``; ``over`` reduces what is left,
    dimension by dimension (``max``, ``min``, ``first``, ``last``, ``mean`` and ``median`` with the interval of the
    bootstrap over realizations, ``interval`` with the stored ends along that dimension, ``range`` of all entries);
``trend``
    the same, smallest ratio of neighbours along the dimension ``along`` (``falling: true`` turns it round);

and may have ``per``, a number of the same kind by which it is divided, ``scale``, ``unit``, ``case`` (a value of what
the text leaves open) or ``each`` (a test for each label of this coordinate), and a ``bound``; see
:func:`granular_response_paper.claims.bounds.declared`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib import resources
from typing import Any

import numpy as np
import xarray as xr

from granular_response.scene import text as yaml

from . import preparations
from .bootstrap import over_realizations
from .bounds import DeclaredError, declared, rise
from .claim import Claim, Data, Measure, Quantity, Test, at, needs
from .words import Words

#: Beside a group's ``claims.py``.
TEXTS = "claims.yaml"

_KEYS = {"event", "table", "friction", "prepared", "value", "at", "where", "over", "trend", "along", "falling", "per"}
_KEYS |= {"scale", "unit", "case", "each", "bound", "what", "group"}
_SIMPLE: dict[str, Callable[..., Any]] = {"max": np.max, "min": np.min}


class Claims(list[Claim]):
    """The claims of a figure group, by its ``package``: those declared, and those with a function.

    ``claims.yaml`` has of each the ``place`` in the paper, the ``paper``'s sentence, what is ``measured``, and if they
    are not the usual: ``here``, ``figures`` (those that the place names), ``source``, ``modal``, ``derivation``,
    ``disorder``, ``remark``; and the ``test`` or ``tests`` unless a function makes them. Raises DeclaredError for a
    test that is not declared as it must be.
    """

    def __init__(self, package: str) -> None:
        self.group = package.rpartition(".")[2]
        self._texts = yaml.read(resources.files(package).joinpath(TEXTS).read_text("utf-8"))
        for id, said in self._texts.items():
            if tests := ([said["test"]] if "test" in said else said.get("tests")):
                for one in tests:
                    _check(f"{self.group}: {id}", one)
                self._add(id, partial(_measured, self.group, said["measured"], tests))

    def measures(self, id: str) -> Callable[[Measure], Measure]:
        """Stands above the function that makes the tests of a claim. Raises KeyError if its text is missing."""

        def measured(measure: Measure) -> Measure:
            self._add(id, measure)
            return measure

        return measured

    def _add(self, id: str, measure: Measure) -> None:
        said = {"figures": _figures(self._texts[id]["place"]), **self._texts[id]}
        said = {name: value for name, value in said.items() if name not in ("test", "tests")}
        self.append(Claim(id, measure=measure, group=self.group, **said | {"figures": tuple(said["figures"])}))

    def needs(self, there: object, what: str) -> None:
        """Raises NotMeasured, which says ``what`` the group's datasets hold or lack, unless ``there`` is true."""
        needs(there, f"data/{self.group}.nc: {what}")


def _figures(place: str) -> tuple[int, ...]:
    """The figures in a place of the paper such as "V.F, Fig. 17e, f"."""
    named = "".join(re.findall(r"Figs?\. (.*)", place))
    return tuple(int(number) for number in re.findall(r"\d+", named))


def _check(name: str, test: Mapping[str, Any]) -> None:
    if unknown := set(test) - _KEYS:
        raise DeclaredError(f"{name}: unknown key {', '.join(sorted(unknown))}, must be of {', '.join(sorted(_KEYS))}")
    if sum(kind in test for kind in ("event", "value", "trend")) != 1:
        raise DeclaredError(f"{name}: a test needs one of event, value, trend")


def _measured(group: str, what: str, tests: Sequence[Mapping[str, Any]], data: Data, words: Words) -> list[Test]:
    found = []
    for spec in tests:
        name, unit, bound = spec.get("what", what), spec.get("unit", ""), declared(spec["bound"], words)
        for case, number in _numbers(group, spec, data):
            found.append(Test(name, number, bound, case, unit))
        if spec.get("prepared"):
            found += [
                Test(name, number, bound, unit=unit, prepared=way)
                for way, number in preparations.events(data, spec["event"], float(spec["friction"])).items()
            ]
    return found


def _numbers(group: str, spec: Mapping[str, Any], data: Data) -> Iterator[tuple[str, Quantity]]:
    """The number, or one for each label, with the name of the case."""
    dimension = spec.get("each")
    if not dimension:
        yield spec.get("case", ""), _number(group, spec, data)
        return
    source = spec.get("value") or spec["trend"]
    labels = _where(data.get(group, source.partition(".")[0]), spec)[dimension].values.tolist()
    needs(labels, f"data/{group}.nc: no {dimension} is stored in that range")
    for label in labels:
        shown = label if isinstance(label, str) else f"{dimension.replace('_', ' ')} {label:g}"
        yield shown, _number(group, {**spec, "at": {**spec.get("at", {}), dimension: label}}, data)


def _number(group: str, spec: Mapping[str, Any], data: Data) -> Quantity:
    if "event" in spec:
        friction = spec.get("friction")
        friction = None if friction is None else float(friction)
        found = data.event(spec.get("group", group), spec["event"], friction, spec.get("table", "events"))
    elif "trend" in spec:
        values = _selected(group, spec, spec["trend"], data)
        along = [_reduced(values.isel({spec["along"]: k}), spec) for k in range(values.sizes[spec["along"]])]
        found = rise(along[::-1] if spec.get("falling") else along)
    else:
        found = _reduced(_selected(group, spec, spec["value"], data), spec)
    if "per" in spec:
        found = found.per(_number(group, spec["per"], data))
    scale = float(spec.get("scale", 1.0))
    return found if scale == 1.0 else replace(found, **{k: scale * getattr(found, k) for k in ("value", "low", "high")})


def _where(study: xr.Dataset, spec: Mapping[str, Any]) -> xr.Dataset:
    for name, (low, high) in spec.get("where", {}).items():
        inside = (study[name].values >= low) & (study[name].values <= high)
        study = study.isel({study[name].dims[0]: inside})
    return study


def _selected(group: str, spec: Mapping[str, Any], source: str, data: Data) -> xr.DataArray:
    name, variable = source.split(".")
    study = at(_where(data.get(group, name), spec), **spec.get("at", {}))
    if "along" in spec:
        study = study.sortby(spec["along"])
    return study[variable]


def _reduced(values: xr.DataArray, spec: Mapping[str, Any]) -> Quantity:
    for dimension, how in spec.get("over", {}).items():
        if how in ("mean", "median"):
            return over_realizations(values.values.reshape(-1), getattr(np, how))
        if how == "interval":
            value, low, high = values.values.tolist()
            return Quantity(value, low, high, "confidence", "bootstrap of the mean")
        if how == "range":
            return Quantity.range(values.values.reshape(-1))
        if how in ("first", "last"):
            values = values.isel({dimension: 0 if how == "first" else -1})
        elif how in _SIMPLE:
            values = values.reduce(_SIMPLE[how], dimension)
        else:
            raise DeclaredError(f"over {dimension}: {how}, must be one of max, min, first, last, mean, median, range")
    needs(values.size == 1, f"{values.name}: {values.size} numbers in place of one")
    return Quantity.exact(float(values.values.reshape(-1)[0]))
