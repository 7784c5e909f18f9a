"""A stored result as it is read: whole, consistent, and in the layout of today, or an error of one line.

A digest says that a file is as it was written, not that a result was written. What reads results comes here, so that
nothing after it meets a missing variable, an index without its disk or a position that is no number.
"""

from __future__ import annotations

import json
import os
from dataclasses import fields
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from ..state import Certificate, Event, status
from ..state.box import FARTHEST, WALL_MEANINGS
from . import files
from .labels import labelled
from .result import (
    ADDED_LATER,
    EVENT_KINDS,
    ROLLING_VARIABLES,
    ResultError,
    described_events,
    described_forces,
    floor_force_change,
    indexed,
    load_coordinates,
    state_from,
)

_REAL, _WHOLE, _TEXT = "fiu", "iu", "UO"
#: What names of variables of contacts begin with, and their dimension.
_CONTACTS = {"contact": "contact", "wall": "wall_contact"}
#: Variables that every result has: dimensions and kinds of numbers.
_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    "position": (("state", "disk", "axis"), _REAL),
    "angle": (("state", "disk"), _REAL),
    "velocity": (("state", "disk", "axis"), _REAL),
    "angular_velocity": (("state", "disk"), _REAL),
    "state_load_factor": (("state",), _REAL),
    "radius": (("disk",), _REAL),
    "mass": (("disk",), _REAL),
    "loaded_disk": (("load_point",), _WHOLE),
    "applied_load": (("load_point", "component"), _REAL),
    "floor_disk": (("floor_disk",), _WHOLE),
    "x": (("floor_disk",), _REAL),
    "floor_force_rest": (("floor_disk",), _REAL),
    "contact_disk": (("contact",), _WHOLE),
    "contact_partner": (("contact",), _WHOLE),
    "wall_disk": (("wall_contact",), _WHOLE),
    "wall_index": (("wall_contact",), _WHOLE),
    **{
        f"{prefix}_{name}": (("state", dimension), _WHOLE if name == "status" else _REAL)
        for prefix, dimension in _CONTACTS.items()
        for name in ("overlap", "normal_force", "tangential_force", "spring", "status")
    },
}
#: Variables of contacts that resist rolling.
_ROLLING = {
    f"{prefix}_{name}": (("state", dimension), _WHOLE if name == "rolling_status" else _REAL)
    for prefix, dimension in (("contact", "contact"), ("wall", "wall_contact"))
    for name in ROLLING_VARIABLES
}
#: Names whose values are indices of disks.
_DISKS = ("contact_disk", "contact_partner", "wall_disk", "loaded_disk", "floor_disk")
_CODES = {
    "wall_index": len(WALL_MEANINGS),
    "contact_status": len(status.MEANINGS),
    "wall_status": len(status.MEANINGS),
}
_POSITIVE = ("radius", "mass")
_CERTIFICATE = {f"certificate_{field.name}" for field in fields(Certificate)}
#: Variables of the events of a path; those with places are not known for events of versions before.
_EVENTS = {
    "event_load_factor": _REAL,
    "event_kind": _WHOLE,
    "event_first": _WHOLE,
    "event_second": _WHOLE,
    "event_at_wall": _WHOLE,
    "event_x": _REAL,
    "event_z": _REAL,
    "event_until": _REAL,
    "event_displacement": _REAL,
    "event_reason": _TEXT,
    "event_state": _WHOLE,
}
_UNKNOWN = ("event_x", "event_z")
#: What versions before wrote of equilibria that were lost.
_CROSSINGS = {"crossing_start": _REAL, "crossing_end": _REAL, "crossing_displacement": _REAL, "crossing_reason": _TEXT}


def read_result(path: str | os.PathLike[str], *, sealed: bool = True) -> xr.Dataset:
    """The result in a file, checked; one of the layout before is brought into that of today.

    ``sealed=False`` takes what xarray has written of a result too.

    Raises
    ------
    granular_response.store.files.StoreError
        If the file cannot be read.
    ResultError
        If it holds something else than a whole result.
    """
    dataset = files.read(path, sealed=sealed).get("")
    try:
        if dataset is None or "contact_spring" not in dataset:
            raise ResultError("holds no states, must be a result of granular-response run")
        return checked(dataset)
    except ResultError as error:
        raise ResultError(f"{os.fspath(path)}: {error}") from error.__cause__


def checked(dataset: xr.Dataset) -> xr.Dataset:
    """A result in the layout of today. Raises ResultError, naming what is wrong, unless it is whole and consistent."""
    older = "state_load_factor" not in dataset and dataset.get("load_factor", np.zeros(1)).ndim == 1
    if older:
        dataset = dataset.reset_coords("load_factor", drop=False) if "load_factor" in dataset.coords else dataset
        dataset = dataset.rename(load_factor="state_load_factor")
    for name, (dimensions, kinds) in _NEEDED.items():
        _check_variable(dataset, name, dimensions, kinds)
    if not older:  # else made from the states
        for prefix, dimension in _CONTACTS.items():
            _check_variable(dataset, f"{prefix}_force", ("state", dimension, "axis"), _REAL)
    states, disks = dataset.sizes["state"], dataset.sizes["disk"]
    if not states or not disks or dataset.sizes["axis"] != 2 or dataset.sizes["component"] != 3:
        _fail("must have a state, a disk, 2 axes and 3 components of loads")
    for name in _DISKS:
        _check_range(dataset, name, disks)
    for name, count in _CODES.items():
        _check_range(dataset, name, count)
    for name in _POSITIVE:
        if not (dataset[name].values > 0).all():
            _fail(f"variable {name}: must be greater than 0")
    if np.abs(dataset["position"].values).max() > FARTHEST:
        _fail(f"variable position: must be at most {FARTHEST:g} mean radii away")
    if np.any(dataset["contact_disk"].values == dataset["contact_partner"].values):
        _fail("variables contact_disk, contact_partner: a disk touches itself")
    if any(name in dataset for name in _CERTIFICATE):
        for name in sorted(_CERTIFICATE - (ADDED_LATER - set(dataset.variables))):
            _check_variable(dataset, name, ("state",), _REAL, finite=False)
    dataset = _along_load(dataset)
    for name in ("floor_force", "floor_force_change", "floor_response"):  # nan under a load of nothing
        _check_variable(dataset, name, ("load", "floor_disk"), _REAL, finite=False)
    if states > 1:
        _check_variable(dataset, "total_force", ("load",), _REAL)
    for name, (dimensions, kinds) in _ROLLING.items():
        if name in dataset:
            _check_variable(dataset, name, dimensions, kinds)
            if name.endswith("status"):
                _check_range(dataset, name, len(status.MEANINGS))
    if "reaction" in dataset:
        _check_variable(dataset, "reaction", ("load", "load_point", "axis"), _REAL)
    if dataset.sizes["load"] != states - 1:
        _fail(f"dimension load: must have {states - 1} entries, one less than state")
    dataset = _with_events(dataset)
    if "event" in dataset.dims or any(name in dataset for name in _EVENTS):
        _check_events(dataset)
    _check_attributes(dataset.attrs)
    if older:
        dataset = dataset.assign(described_forces([state_from(dataset, k) for k in range(states)]))
    return indexed(labelled(dataset))


def _along_load(dataset: xr.Dataset) -> xr.Dataset:
    """A result of versions before, which had no branches, and no dimension ``load`` for one load or none."""
    if "branch" in dataset.variables:
        return dataset
    count = dataset.sizes["state"] - 1
    dataset = dataset.drop_vars(["load", "load_factor", "step"], errors="ignore")
    if count < 2:
        names = [name for name in ("floor_force", "floor_response", "total_force", "reaction") if name in dataset]
        alone = {name: dataset.variables[name] for name in names if "load" not in dataset.variables[name].dims}
        dataset = dataset.assign({name: one.set_dims(("load", *one.dims))[:count] for name, one in alone.items()})
    dataset = dataset.assign_coords(load_coordinates(dataset["state_load_factor"].values[1:].tolist()))
    if "floor_force" not in dataset or dataset["floor_force"].dims != ("load", "floor_disk"):
        return dataset  # which is refused
    return dataset.assign(floor_force_change(dataset["floor_force"].values, dataset["floor_force_rest"].values))


def _with_events(dataset: xr.Dataset) -> xr.Dataset:
    """Lost equilibria as versions before wrote them, of the whole programme together, as events of today."""
    if not any(name in dataset for name in _CROSSINGS):
        return dataset
    for name, kinds in _CROSSINGS.items():
        _check_variable(dataset, name, ("crossing",), kinds)
    factors = dataset["state_load_factor"].values.tolist()
    stretches = [sorted(ends) for ends in pairwise(factors)]
    found, state = [], 1
    for start, until, moved, reason in zip(*(dataset[name].values.tolist() for name in _CROSSINGS), strict=True):
        # they are in order: each is on the first stretch, from that of the one before on, that holds its load
        while state < len(stretches) and not stretches[state - 1][0] <= start < stretches[state - 1][1]:
            state += 1
        found.append((state, Event(start, "jump", until=until, displacement=moved, reason=str(reason))))
    return dataset.drop_vars(_CROSSINGS).assign(described_events(found))


def _check_events(dataset: xr.Dataset) -> None:
    for name, kinds in _EVENTS.items():
        _check_variable(dataset, name, ("event",), kinds, finite=name not in _UNKNOWN)
    disks = dataset.sizes["disk"]
    _check_range(dataset, "event_state", dataset.sizes["state"])
    _check_range(dataset, "event_kind", len(EVENT_KINDS))
    _check_range(dataset, "event_at_wall", 2)
    _check_range(dataset, "event_first", disks, lowest=-1)
    _check_range(dataset, "event_second", disks, lowest=-1)
    at_wall = dataset["event_at_wall"].values == 1
    _check_range(dataset.isel(event=at_wall), "event_second", len(WALL_MEANINGS))


def _fail(problem: str) -> None:
    raise ResultError(f"is not a whole result: {problem}")


def _check_variable(
    dataset: xr.Dataset, name: str, dimensions: tuple[str, ...], kinds: str, *, finite: bool = True
) -> None:
    if name not in dataset.variables:
        _fail(f"variable {name} is missing")
    variable = dataset.variables[name]
    if variable.dims != dimensions:
        found, needed = (", ".join(map(str, names)) for names in (variable.dims, dimensions))
        _fail(f"variable {name}: has dimensions {found}, must have {needed}")
    if variable.dtype.kind not in kinds:
        _fail(f"variable {name}: has values of type {variable.dtype}")
    if finite and kinds == _REAL and not np.isfinite(variable.values).all():
        _fail(f"variable {name}: must be finite")


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
