"""The parts of a labelled dataset as plain arrays: what is written to disk.

An ``xarray.Dataset`` holds the same and can do much more, but takes a third of a second to load, pandas with it. A
program that solves one scene and stores it has no need of that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


class Values(NamedTuple):
    """A variable: one dimension for each axis of ``values``, and attributes."""

    dimensions: tuple[str, ...]
    values: np.ndarray
    attributes: dict[str, Any]


@dataclass(frozen=True)
class Labelled:
    """Variables by name, the names of those that are coordinates, and the attributes of the whole."""

    variables: Mapping[str, Values] = field(default_factory=dict)
    coordinates: frozenset[str] = frozenset()
    attributes: Mapping[str, Any] = field(default_factory=dict)

    def dataset(self) -> xr.Dataset:
        """The same as an ``xarray.Dataset``."""
        import xarray as xr

        made = {
            name: xr.Variable(dimensions, values, attributes, fastpath=True)
            for name, (dimensions, values, attributes) in self.variables.items()
        }
        coordinates = {name: made.pop(name) for name in list(made) if name in self.coordinates}
        return xr.Dataset(made, coordinates, self.attributes)

    def encoded_variables(self) -> dict[str, Values]:
        """As the CF conventions, and xarray, have them in a file.

        NaN fills what is missing; truth values are small integers; each variable names the coordinates that lie along
        its dimensions. Raises TypeError for values that are neither numbers nor strings.
        """
        encoded = {}
        for name, (dimensions, values, attributes) in self.variables.items():
            labels = {key: _plain(value) for key, value in attributes.items()}
            if along := self._coordinates_of(name):
                labels.setdefault("coordinates", " ".join(along))
            if values.dtype.kind == "b":
                values, labels["dtype"] = values.astype(np.int8), "bool"
            elif values.dtype.kind == "f":
                labels.setdefault("_FillValue", values.dtype.type(np.nan))
            elif values.dtype.kind == "O" and all(isinstance(value, str) for value in values.flat):
                values = values.astype(str)
            elif values.dtype.kind not in "iuU":
                raise TypeError(f"variable {name} has values of type {values.dtype}")
            encoded[name] = Values(dimensions, values, labels)
        return encoded

    def encoded_attributes(self) -> dict[str, Any]:
        """Attributes of the whole, with the names of coordinates that lie along no variable."""
        labels = {key: _plain(value) for key, value in self.attributes.items()}
        named = {coordinate for name in self.variables for coordinate in self._coordinates_of(name)}
        if alone := [coordinate for coordinate in self._not_dimensions() if coordinate not in named]:
            labels.setdefault("coordinates", " ".join(alone))
        return labels

    def _coordinates_of(self, name: str) -> list[str]:
        """Coordinates along the dimensions of a variable, if it is none itself."""
        dimensions, beside = self.variables[name].dimensions, self._not_dimensions()
        if name in beside or name in dimensions:
            return []
        return [c for c in beside if set(self.variables[c].dimensions) <= set(dimensions)]

    def _not_dimensions(self) -> list[str]:
        """Coordinates that are not those of a dimension, by name."""
        dimensions = {d for variable in self.variables.values() for d in variable.dimensions}
        return sorted(self.coordinates - dimensions)


def labelled(data: xr.Dataset | Labelled) -> Labelled:
    """The parts of a dataset."""
    if isinstance(data, Labelled):
        return data
    variables = {
        str(name): Values(tuple(map(str, variable.dims)), np.asarray(variable.values), dict(variable.attrs))
        for name, variable in data.variables.items()
    }
    return Labelled(variables, frozenset(map(str, data.coords)), dict(data.attrs))


def _plain(value: Any) -> Any:
    """Truth values as numbers, which an attribute can hold."""
    return int(value) if isinstance(value, (bool, np.bool_)) else value
