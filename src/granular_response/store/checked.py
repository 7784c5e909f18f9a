"""A stored result as it is read: whole, consistent, and in the layout of today, or an error of one line.

A digest says that a file is as it was written, not that a result was written. What reads results comes here, so that
nothing after it meets a missing variable, an index without its disk or a position that is no number.
"""

from __future__ import annotations

import json
import os
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ..state import Certificate, status
from ..state.box import FARTHEST, WALL_MEANINGS
from . import files
from .result import ResultError, described_forces, indexed, load_coordinates, state_from

if TYPE_CHECKING:
    import xarray as xr

_REAL, _WHOLE, _TEXT = "fiu", "iu", "UO"
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
        for prefix, dimension in (("contact", "contact"), ("wall", "wall_contact"))
        for name in ("overlap", "normal_force", "tangential_force", "spring", "status")
    },
}
#: Names whose values are indices of disks.
_DISKS = ("contact_disk", "contact_partner", "wall_disk", "loaded_disk", "floor_disk")
_CODES = {
    "wall_index": len(WALL_MEANINGS),
    "contact_status": len(status.MEANINGS),
    "wall_status": len(status.MEANINGS),
}
_POSITIVE = ("radius", "mass")
_CERTIFICATE = tuple(f"certificate_{field.name}" for field in fields(Certificate))
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
        for name in _CERTIFICATE:
            _check_variable(dataset, name, ("state",), _REAL, finite=False)
    found = [name for name in _CROSSINGS if name in dataset]
    for name in _CROSSINGS if found else ():
        _check_variable(dataset, name, ("crossing",), _CROSSINGS[name])
    several = ("load",) if states > 2 else ()
    for name in ("floor_force", "floor_response"):  # nan under a load of nothing
        _check_variable(dataset, name, (*several, "floor_disk"), _REAL, finite=False)
    if states > 1:
        _check_variable(dataset, "total_force", several, _REAL)
    if "reaction" in dataset:
        _check_variable(dataset, "reaction", (*several, "load_point", "axis"), _REAL)
    if several and dataset.sizes["load"] != states - 1:
        _fail(f"dimension load: must have {states - 1} entries, one less than state")
    _check_attributes(dataset.attrs)
    return indexed(_renewed(dataset) if older else dataset)


def _renewed(dataset: xr.Dataset) -> xr.Dataset:
    """A result of the layout before, with what has been added since."""
    states = [state_from(dataset, k) for k in range(dataset.sizes["state"])]
    coordinates = load_coordinates([state.load_factor for state in states[1:]])
    return dataset.assign_coords({name: tuple(value) for name, value in coordinates.items()}).assign(
        {name: tuple(value) for name, value in described_forces(states).items()}
    )


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


def _check_range(dataset: xr.Dataset, name: str, count: int) -> None:
    values = dataset[name].values
    bad = values[(values < 0) | (values >= count)]
    if bad.size:
        _fail(f"variable {name}: holds {bad.flat[0]}, must be from 0 to {count - 1}")


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
