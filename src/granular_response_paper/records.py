"""Records: frozen dataclasses whose fields say what they hold, and the labelled datasets made of them.

What a task finds is such a record. A field declared by :func:`column` has a long name, which ends with the unit, and
its dimensions; other fields are not stored. :func:`table` places records along the dimensions of a study (case,
realization, ...), so that each declared field becomes a variable.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from itertools import product
from types import MappingProxyType
from typing import Any, TypeVar, dataclass_transform, get_type_hints

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from granular_response.store.variables import variable

#: Indices along the leading dimensions of a table.
Place = TypeVar("Place", bound=tuple[int, ...])

Kind = TypeVar("Kind")

_DECLARED = "column"


@dataclass(frozen=True)
class Column:
    """How a field is stored."""

    long_name: str
    dims: tuple[str, ...]
    attributes: Mapping[str, Any]  #: further ones of the variable


def column(long_name: str, *dims: str, attributes: Mapping[str, Any] = MappingProxyType({})) -> Any:
    """Declare a field of a record: a number or a text, or an array along ``dims``."""
    return field(metadata={_DECLARED: Column(long_name, dims, attributes)})


@dataclass_transform(frozen_default=True, field_specifiers=(column,))
def record(kind: type[Kind]) -> type[Kind]:
    """Class decorator: a frozen dataclass."""
    return dataclass(frozen=True)(kind)


def columns(kind: type) -> dict[str, Column]:
    """The stored fields of a record by name, in their order."""
    return {one.name: one.metadata[_DECLARED] for one in fields(kind) if _DECLARED in one.metadata}


def table(records: Mapping[Place, Any] | Sequence[Any], *dims: str, kind: type | None = None) -> xr.Dataset:
    """A variable for each stored field, along ``dims`` and those of the field; nan where there is no record.

    Records are of one kind, by their places along ``dims``, the one of no dimension at the place ``()``; a sequence
    goes along one. Arrays of different lengths are padded with nan. ``kind`` is needed where there may be no record.
    """
    placed: Mapping[Any, Any] = (
        records if isinstance(records, Mapping) else {(k,): one for k, one in enumerate(records)}
    )
    kind = kind or type(next(iter(placed.values())))
    hints = get_type_hints(kind)
    data = {}
    for name, one in columns(kind).items():
        number = hints[name] if hints[name] in (float, int, str) else None
        values = stacked({place: getattr(record, name) for place, record in placed.items()}, number)
        data[name] = variable((*dims, *one.dims), values, one.long_name, **one.attributes)
    return xr.Dataset(data)


def stacked(values: Mapping[Place, ArrayLike], dtype: Any = None) -> NDArray[Any]:
    """Arrays by their places along leading dimensions as one.

    Numbers are nan, and texts empty, where there are none and behind shorter ones.
    """
    arrays = {place: np.asarray(value, dtype) for place, value in values.items()}
    if not arrays:
        return np.empty(0, dtype)
    shape = tuple(1 + max(along) for along in zip(*arrays, strict=True))
    sizes = tuple(max(along) for along in zip(*(array.shape for array in arrays.values()), strict=True))
    whole = len(arrays) == math.prod(shape) and all(array.shape == sizes for array in arrays.values())
    kind = np.result_type(*arrays.values())
    result = np.zeros(shape + sizes, kind) if whole or kind.kind == "U" else np.full(shape + sizes, np.nan)
    for place, array in arrays.items():
        result[place + tuple(slice(size) for size in array.shape)] = array
    return result


def labels(dimension: str, of: Iterable[Any], /, **long_names: str) -> dict[str, xr.Variable]:
    """Attributes of each of ``of`` as variables along ``dimension``, by the names of their long names."""
    listed = list(of)
    return {
        name: variable(dimension, [getattr(one, name) for one in listed], text) for name, text in long_names.items()
    }


def variables(**given: tuple[str, ArrayLike, str]) -> dict[str, xr.Variable]:
    """Variables by name: dimensions with spaces between them, values and long name."""
    return {name: variable(dims.split(), values, text) for name, (dims, values, text) in given.items()}


def axes(**given: tuple[Iterable[Any], str]) -> dict[str, xr.Variable]:
    """Coordinates along their own dimensions: by name, values and long name."""
    return {
        name: variable(name, values if isinstance(values, np.ndarray) else list(values), text)
        for name, (values, text) in given.items()
    }


def parts(records: Mapping[Place, Any], name: str) -> dict[tuple[int, ...], Any]:
    """What records have several of in one field: each by the place of its record and its own number there."""
    return {(*place, k): part for place, one in records.items() for k, part in enumerate(getattr(one, name))}


def places(*along: Sequence[Any] | NDArray[Any]) -> Iterator[tuple[tuple[int, ...], tuple[Any, ...]]]:
    """Places in a grid and the values of its axes ``along`` there; the last place runs fastest."""
    return zip(np.ndindex(*map(len, along)), product(*along), strict=True)


def table_along(records: Mapping[Place, Any] | Sequence[Any], /, **given: tuple[Iterable[Any], str]) -> xr.Dataset:
    """A :func:`table` with its :func:`axes`: those of the places first, then those of fields."""
    leading = len(next(iter(records))) if isinstance(records, Mapping) else 1
    return table(records, *list(given)[:leading]).assign_coords(axes(**given))


def alike(data: xr.Dataset, dimension: str, *names: str) -> dict[tuple[Any, ...], xr.Dataset]:
    """The parts of ``data`` along a dimension in which variables have the same values, by these, as they come first."""
    keys = list(zip(*(data[name].values.tolist() for name in names), strict=True))
    return {key: data.isel({dimension: [one == key for one in keys]}) for key in dict.fromkeys(keys)}
