"""Packings of a figure group that the survey has simulated, as they are stored: one entry for each.

What a group measures on one packing is a record (:mod:`granular_response_paper.records`), and so is what tells the
packing from others. Numbers are kept in single precision, so the group takes packings that it has simulated itself and
stored ones alike.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.store import files as store
from granular_response_paper.parameters import SurveyedGroup
from granular_response_paper.records import columns, table
from granular_response_paper.tasks import computed

Outcome = TypeVar("Outcome")
#: A record of what tells packings of a group apart.
Key = TypeVar("Key", bound=Hashable)
#: What a group calls a packing by.
Place = TypeVar("Place", bound=Hashable)
Group = TypeVar("Group", bound=SurveyedGroup)
#: Name of the dataset in its file, and of its dimension.
DATASET, ALONG = "packings", "packing"
#: Dimension that may be shorter in some packings; nan fills it up.
RAGGED = "line"


def dataset(outcomes: Mapping[Any, Any]) -> xr.Dataset:
    """Outcomes by their keys."""
    found = table(list(outcomes.values()), ALONG).astype(np.float32)
    return found.assign_coords(table(list(outcomes), ALONG).variables)


def read(path: str | Path, key: type[Key], kind: type[Outcome]) -> dict[Key, Outcome]:
    """Stored outcomes of a ``kind`` by their keys, in double precision.

    Raises StoreError if the file cannot be read, or holds no packings of this kind.
    """
    found = store.read(path).get(DATASET)
    named, values = columns(key), columns(kind)
    needed = {*named, *(name for name, one in values.items() if not one.later)}
    missing = needed - set(found.variables if found is not None else ())
    if found is None or missing:
        raise store.StoreError(f"{path}: is no file of packings of the survey, lacks {', '.join(sorted(missing))}")
    keys = zip(*(found[name].values.tolist() for name in named), strict=True)
    unknown = np.full(found.sizes[ALONG], np.nan)
    stored = {name: found[name].values if name in found else unknown for name in values}
    return {
        key(*one): kind(**{name: _own(stored[name][row], column.dims) for name, column in values.items()})
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
    task: Callable[[Group, Any], Callable[[], Outcome]],
    kind: type[Outcome],
    *,
    work: Callable[[Place], Any] | None = None,
) -> dict[Place, Outcome]:
    """The outcomes of a group by their places: computed, or as the survey has stored them.

    ``packings(group, surveyed=...)`` are what tells them apart, of the survey or all others; ``task`` simulates one.

    Raises what :func:`chosen` and ``computed`` raise.
    """
    own = {place: task(group, key) for place, key in packings(group, surveyed=False).items()}
    return computed(own, what, work=work) | chosen(group.survey_file, kind, packings(group, surveyed=True))


def chosen(path: str | None, kind: type[Outcome], keys: Mapping[Place, Any]) -> dict[Place, Outcome]:
    """The outcomes of some packings, by their places in a group; without any, no file is needed.

    Raises what :func:`read` raises, and StoreError if one of them is not there: the message names the first.
    """
    if not keys:
        return {}
    stored = read(path or "", type(next(iter(keys.values()))), kind)
    for key in keys.values():
        if key not in stored:
            named = ", ".join(f"{name} {value}" for name, value in asdict(key).items())
            raise store.StoreError(f"{path}: has no packing of {named}; make survey simulates it")
    return {place: stored[key] for place, key in keys.items()}
