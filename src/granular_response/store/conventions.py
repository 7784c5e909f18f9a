"""Datasets as the CF conventions, and xarray, have them in a file: the same bytes for the same data."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr


class Encoded(NamedTuple):
    """A variable: one dimension for each axis of ``values``, and attributes."""

    dimensions: tuple[str, ...]
    values: np.ndarray
    attributes: dict[str, Any]


def encoded_variables(dataset: xr.Dataset) -> dict[str, Encoded]:
    """Variables by name.

    NaN fills what is missing; truth values are small integers; each variable names the coordinates that lie along its
    dimensions. Raises TypeError for values that are neither numbers nor strings.
    """
    encoded = {}
    for name, variable in dataset.variables.items():
        values, labels = np.asarray(variable.values), _plain(variable.attrs)
        if along := _coordinates_of(dataset, name):
            labels.setdefault("coordinates", " ".join(along))
        if values.dtype.kind == "b":
            values, labels["dtype"] = values.astype(np.int8), "bool"
        elif values.dtype.kind == "f":
            labels.setdefault("_FillValue", values.dtype.type(np.nan))
        elif values.dtype.kind == "O" and all(isinstance(value, str) for value in values.flat):
            values = values.astype(str)
        elif values.dtype.kind not in "iuU":
            raise TypeError(f"variable {name} has values of type {values.dtype}")
        encoded[str(name)] = Encoded(tuple(map(str, variable.dims)), values, labels)
    return encoded


def encoded_attributes(dataset: xr.Dataset) -> dict[str, Any]:
    """Attributes of the whole, with the names of coordinates that lie along no variable."""
    labels = _plain(dataset.attrs)
    named = {coordinate for name in dataset.variables for coordinate in _coordinates_of(dataset, name)}
    if alone := [coordinate for coordinate in _not_dimensions(dataset) if coordinate not in named]:
        labels.setdefault("coordinates", " ".join(alone))
    return labels


def _coordinates_of(dataset: xr.Dataset, name: Any) -> list[str]:
    """Coordinates along the dimensions of a variable, if it is none itself."""
    dimensions, beside = dataset.variables[name].dims, _not_dimensions(dataset)
    if name in beside or name in dimensions:
        return []
    return [c for c in beside if set(dataset.variables[c].dims) <= set(dimensions)]


def _not_dimensions(dataset: xr.Dataset) -> list[str]:
    """Coordinates that are not those of a dimension, by name."""
    return sorted(str(name) for name in dataset.coords if name not in dataset.dims)


def _plain(attributes: dict[Any, Any]) -> dict[str, Any]:
    """Truth values as numbers, which an attribute can hold."""
    return {str(k): int(v) if isinstance(v, (bool, np.bool_)) else v for k, v in attributes.items()}
