"""Packings of a figure group that the survey has simulated, as they are stored: one entry for each.

What a group measures on one packing is a dataclass of numbers and arrays. It is kept as it is, in single precision, so
the group takes packings that it has simulated itself and stored ones alike.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.store import files as store
from granular_response.store.result import variable

Outcome = TypeVar("Outcome")
#: What a group calls a packing by.
Place = TypeVar("Place", bound=Hashable)
#: What tells packings of a group apart, in the order of the names of :attr:`Layout.keys`.
Key = tuple[float | int | str, ...]
#: Name of the dataset in its file, and of its dimension.
DATASET, ALONG = "packings", "packing"
#: Dimension that may be shorter in some packings; nan fills it up.
RAGGED = "line"


@dataclass(frozen=True)
class Layout(Generic[Outcome]):
    """How the outcomes of a group are stored."""

    kind: type[Outcome]
    keys: Mapping[str, str]  #: names of the parts of a key, with long names
    values: Mapping[str, tuple[tuple[str, ...], str]]  #: fields of the outcome: dimensions and long names
    later: tuple[str, ...] = ()  #: numbers that files of earlier versions lack: they are read as nan, not recorded


def dataset(layout: Layout[Outcome], outcomes: Mapping[Key, Outcome], seconds: Sequence[float]) -> xr.Dataset:
    """Outcomes by their keys, with the processor time (s) of each."""
    data = {
        name: variable((ALONG, *dims), _stacked([getattr(one, name) for one in outcomes.values()]), text)
        for name, (dims, text) in layout.values.items()
    }
    data["processor_time"] = variable(ALONG, np.array(seconds, np.float32), "processor time of the packing (s)")
    parts = zip(*outcomes, strict=True)
    coordinates = {
        name: variable(ALONG, list(values), text)
        for (name, text), values in zip(layout.keys.items(), parts, strict=True)
    }
    return xr.Dataset(data, coords=coordinates)


def _stacked(values: list[Any]) -> NDArray[np.float32]:
    arrays = [np.asarray(value, np.float32) for value in values]
    shape = np.max([array.shape for array in arrays], axis=0).astype(int) if arrays[0].ndim else ()
    stacked = np.full((len(arrays), *shape), np.nan, np.float32)
    for row, array in zip(stacked if len(shape) else stacked[:, None], arrays, strict=True):
        row[tuple(slice(size) for size in array.shape) or slice(None)] = array
    return stacked


def read(path: str | Path, layout: Layout[Outcome]) -> dict[Key, Outcome]:
    """Stored outcomes by their keys, in double precision.

    Raises
    ------
    granular_response.store.files.StoreError
        If the file cannot be read, or is none of this layout.
    """
    found = store.read(path).get(DATASET)
    missing = {*layout.keys, *layout.values} - {*layout.later} - set(found.variables if found is not None else ())
    if found is None or missing:
        raise store.StoreError(f"{path}: is no file of packings of the survey, lacks {', '.join(sorted(missing))}")
    keys = zip(*(found[name].values.tolist() for name in layout.keys), strict=True)
    unknown = np.full(found.sizes[ALONG], np.nan)
    columns = {name: found[name].values if name in found else unknown for name in layout.values}
    return {
        key: layout.kind(**{name: _own(columns[name][row], layout.values[name][0]) for name in layout.values})
        for row, key in enumerate(keys)
    }


def _own(value: NDArray[np.float32], dims: tuple[str, ...]) -> Any:
    """A number, or an array without what filled it up."""
    if not dims:
        return float(value)
    if dims[0] == RAGGED:
        value = value[np.isfinite(value).reshape(len(value), -1).any(axis=1)]
    return value.astype(float)


def chosen(path: str | None, layout: Layout[Outcome], keys: Mapping[Place, Key]) -> dict[Place, Outcome]:
    """The outcomes of some packings, by their places in a group; without any, no file is needed.

    Raises
    ------
    granular_response.store.files.StoreError
        Also if one of them is not there: the message names the first.
    """
    if not keys:
        return {}
    stored = read(path or "", layout)
    for key in keys.values():
        if key not in stored:
            named = ", ".join(f"{name} {value}" for name, value in zip(layout.keys, key, strict=True))
            raise store.StoreError(f"{path}: has no packing of {named}; make survey simulates it")
    return {place: stored[key] for place, key in keys.items()}
