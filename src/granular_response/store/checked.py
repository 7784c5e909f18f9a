"""A stored result as it is read: whole and consistent, or an error of one line.

A digest says that a file is as it was written, not that a result was written. What reads results comes here, so that
nothing after it meets a missing variable, an index without its disk or a position that is no number.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, Never

import numpy as np
import xarray as xr

from ..state.box import FARTHEST, WALL_MEANINGS
from . import files
from .result import ResultError, indexed
from .variables import REAL, VARIABLES, StoredVariable, labelled

#: Names whose values are indices of disks.
_DISKS = ("contact_disk", "contact_partner", "wall_disk", "loaded_disk", "floor_disk")
_POSITIVE = ("radius", "mass")


def read_result(path: str | os.PathLike[str], *, sealed: bool = True) -> xr.Dataset:
    """The result in a file, checked; ``sealed=False`` takes what xarray has written of a result too.

    Raises StoreError if the file cannot be read, ResultError if it holds something else than a whole result.
    """
    return result_of(path, files.read(path, sealed=sealed))


def result_of(path: str | os.PathLike[str], datasets: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """The result among the datasets of a file, checked. Raises ResultError, with the path."""
    dataset = datasets.get("")
    try:
        if dataset is None or "contact_spring" not in dataset:
            raise ResultError("holds no states, must be a result of granular-response run")
        return checked(dataset)
    except ResultError as error:
        raise ResultError(f"{os.fspath(path)}: {error}") from error.__cause__


def checked(dataset: xr.Dataset) -> xr.Dataset:
    """A result with labels and indices; ResultError, with what is wrong, unless it is whole."""
    events = "event" in dataset.dims or any(str(name).startswith("event_") for name in dataset.variables)
    for name, stored in VARIABLES.items():
        needed = events if name.startswith("event_") else not stored.optional
        if needed or name in dataset.variables:
            _check_variable(dataset, name, stored)
    sizes = dataset.sizes
    if not sizes["state"] or not sizes["disk"] or sizes["axis"] != 2 or sizes["component"] != 3:
        _fail("must have a state, a disk, 2 axes and 3 components of loads")
    if sizes["load"] != sizes["state"] - 1:
        _fail(f"dimension load: must have {sizes['state'] - 1} entries, one less than state")
    for name in _DISKS:
        _check_range(dataset, name, sizes["disk"])
    for name in _POSITIVE:
        if not (dataset[name].values > 0).all():
            _fail(f"variable {name}: must be greater than 0")
    if np.abs(dataset["position"].values).max() > FARTHEST:
        _fail(f"variable position: must be at most {FARTHEST:g} mean radii away")
    if np.any(dataset["contact_disk"].values == dataset["contact_partner"].values):
        _fail("variables contact_disk, contact_partner: a disk touches itself")
    if events:
        _check_range(dataset, "event_state", sizes["state"])
        _check_range(dataset, "event_first", sizes["disk"], lowest=-1)
        for at_wall, count, lowest in ((0, sizes["disk"], -1), (1, len(WALL_MEANINGS), 0)):
            of_kind = dataset.isel(event=dataset["event_at_wall"].values == at_wall)
            _check_range(of_kind, "event_second", count, lowest=lowest)
    _check_attributes(dataset.attrs)
    return indexed(labelled(dataset))


def _fail(problem: str) -> Never:
    raise ResultError(f"is not a whole result: {problem}")


def _check_variable(dataset: xr.Dataset, name: str, stored: StoredVariable) -> None:
    if name not in dataset.variables:
        _fail(f"variable {name} is missing")
    variable, dimensions = dataset.variables[name], tuple(stored.dimensions.split())
    if variable.dims != dimensions:
        found, needed = (", ".join(map(str, names)) for names in (variable.dims, dimensions))
        _fail(f"variable {name}: has dimensions {found}, must have {needed}")
    if variable.dtype.kind not in stored.kinds:
        _fail(f"variable {name}: has values of type {variable.dtype}")
    if stored.finite and stored.kinds == REAL and not np.isfinite(variable.values).all():
        _fail(f"variable {name}: must be finite")
    if stored.codes:
        _check_range(dataset, name, len(stored.codes))


def _check_range(dataset: xr.Dataset, name: str, count: int, *, lowest: int = 0) -> None:
    values = dataset[name].values
    bad = values[(values < lowest) | (values >= count)]
    if bad.size:
        _fail(f"variable {name}: holds {bad.flat[0]}, must be from {lowest} to {count - 1}")


def _check_attributes(attributes: dict[Any, Any]) -> None:
    if not isinstance(attributes.get("scene"), str):
        _fail("attribute scene is missing, must be the scene as YAML")
    width = attributes.get("width")
    if not isinstance(width, (int, float, np.number)) or not 0 < width <= FARTHEST:
        _fail(f"attribute width: must be a number greater than 0, at most {FARTHEST:g}")
    if attributes.get("sides", "walls") not in ("walls", "periodic"):
        _fail("attribute sides: must be walls or periodic")
    for name in ("method", "method_reason"):
        try:
            known = isinstance(json.loads(attributes.get(name, "{}")), dict)
        except (TypeError, ValueError, RecursionError):
            known = False
        if not known:
            _fail(f"attribute {name}: must be a mapping as JSON")
