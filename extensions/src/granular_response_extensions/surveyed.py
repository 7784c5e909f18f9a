"""Packings that a figure group leaves to the survey: higher ones and more realizations than its pipeline has time for.

The group says which in its section of ``params.yaml``; ``packings`` and ``task`` of its ``simulate`` make them as those
of the pipeline, and :func:`block` is what the survey simulates and stores, one entry for each packing.

What a group measures on one packing is a record (:mod:`granular_response_paper.records`), and so is what tells the
packing from others. Numbers are kept in single precision, so the group takes packings that it has simulated itself and
stored ones alike.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.store import files as store
from granular_response_extensions import COLLECTION
from granular_response_extensions.parameters import SurveyedGroup
from granular_response_paper import PACKAGE
from granular_response_paper.pipeline import simulation
from granular_response_paper.records import columns, table
from granular_response_paper.registry import group_member
from granular_response_paper.survey.simulate import MECHANICS, Block
from granular_response_paper.tasks import computed

Found = TypeVar("Found")
#: A record of what tells packings of a group apart.
Key = TypeVar("Key", bound=Hashable)
#: What a group calls a packing by.
Place = TypeVar("Place", bound=Hashable)
Group = TypeVar("Group", bound=SurveyedGroup)
#: Name of the dataset in its file, and of its dimension.
DATASET, ALONG = "packings", "packing"
#: Dimension that may be shorter in some packings; nan fills it up.
RAGGED = "line"


def surveyed_groups() -> list[str]:
    """The figure groups that may leave packings to the survey."""
    return [
        name for name in COLLECTION.groups if issubclass(group_member(name, "parameters", "Parameters"), SurveyedGroup)
    ]


def block(group: str, parameter_file: Path) -> Block:
    """The packings that the section of a group leaves to the survey, the smallest first.

    Raises what ``simulation.parameters`` raises.
    """
    given, parameters = simulation.parameters(group, parameter_file)
    tasks = tasks_of(group, parameters)

    def datasets(found: dict[Any, Any]) -> dict[str, xr.Dataset]:
        outcomes = table([found[key] for key in tasks], ALONG).astype(np.float32)
        return {DATASET: outcomes.assign_coords(table(list(tasks), ALONG).variables)}

    # the first argument of each is its scene
    ordered = dict(sorted(tasks.items(), key=lambda item: item[1].args[0].packing.disk_count))
    base = parameters.base  # type: ignore[attr-defined]
    return Block(group, ordered, datasets, base, given, sources_of(group), (PACKAGE, COLLECTION.package))


def tasks_of(group: str, parameters: Any) -> dict[Any, partial[Any]]:
    """The tasks of the packings that a group leaves to the survey, by what tells these apart."""
    packings, task = (group_member(group, "simulate", name) for name in ("packings", "task"))
    return {key: task(parameters, key) for key in packings(parameters, surveyed=True).values()}


def sources_of(group: str) -> tuple[str, ...]:
    """The sources that an outcome of a group's task depends on."""
    return (*MECHANICS, "theory", f"{COLLECTION.package}/{group}/simulate")


def read(path: str | Path, key: type[Key], kind: type[Found]) -> dict[Key, Found]:
    """Stored outcomes of a ``kind`` by their keys, in double precision.

    Raises StoreError if the file cannot be read, or holds no packings of this kind.
    """
    found = store.read(path).get(DATASET)
    named, values = columns(key), columns(kind)
    missing = {*named, *values} - set(found.variables if found is not None else ())
    if found is None or missing:
        raise store.StoreError(f"{path}: is no file of packings of the survey, lacks {', '.join(sorted(missing))}")
    keys = zip(*(found[name].values.tolist() for name in named), strict=True)
    return {
        key(*one): kind(**{name: _own(found[name].values[row], column.dims) for name, column in values.items()})
        for row, one in enumerate(keys)
    }


def _own(value: NDArray[np.float32], dims: tuple[str, ...]) -> Any:
    """A number, or an array without what filled it up."""
    if not dims:
        return float(value)
    if dims[0] == RAGGED:
        value = value[np.isfinite(value).reshape(len(value), -1).any(axis=1)]
    return value.astype(float)


def measured(
    group: Group,
    what: str,
    packings: Callable[..., Mapping[Place, Any]],
    task: Callable[[Group, Any], Callable[[], Found]],
    kind: type[Found],
    *,
    work: Callable[[Place], Any] | None = None,
) -> dict[Place, Found]:
    """The outcomes of a group by their places: computed, or as the survey has stored them.

    ``packings(group, surveyed=...)`` are what tells them apart, of the survey or all others; ``task`` simulates one.

    Raises what ``computed`` and, with packings of the survey, :func:`read` raise, and StoreError if one of them is not
    there: the message names the first.
    """
    own = {place: task(group, key) for place, key in packings(group, surveyed=False).items()}
    found, left = computed(own, what, work=work), packings(group, surveyed=True)
    stored = read(group.survey_file or "", type(next(iter(left.values()))), kind) if left else {}
    for place, key in left.items():
        if key not in stored:
            named = ", ".join(f"{name} {value}" for name, value in asdict(key).items())
            raise store.StoreError(f"{group.survey_file}: has no packing of {named}; make survey simulates it")
        found[place] = stored[key]
    return found
