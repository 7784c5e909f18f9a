"""Results of versions before events were stored, also of their first layout, brought into that of today."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import xarray as xr

from ..scene import text as scene_text
from ..scene.protocol import without_replaced
from ..state import Event
from .result import ResultError, described_events, described_forces, load_coordinates, state_from
from .variables import described

#: What those versions wrote of equilibria that were lost.
_CROSSINGS = ("crossing_start", "crossing_end", "crossing_displacement", "crossing_reason")
#: What they wrote without the dimension ``load`` for one load or none.
_UNDER_LOAD = ("floor_force", "floor_response", "total_force", "reaction")


def of_today(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with today's coordinates along ``load``, events, and a scene without keys that are gone.

    One of today is returned as it is. Raises ResultError where a part of what those versions wrote is missing.
    """
    if "branch" in dataset.variables or "scene" not in dataset.attrs or "state" not in dataset.dims:
        return dataset
    if "state_load_factor" not in dataset and "load_factor" in dataset.variables:
        dataset = dataset.reset_coords("load_factor").rename(load_factor="state_load_factor")
    if "state_load_factor" not in dataset or dataset["state_load_factor"].dims != ("state",):
        return dataset  # which is refused
    if "contact_force" not in dataset and "contact_spring" in dataset:
        states = [state_from(dataset, k) for k in range(dataset.sizes["state"])]
        dataset = dataset.assign(described_forces(states))
    scene = without_replaced(scene_text.read(dataset.attrs["scene"]))
    return _with_events(_along_load(dataset)).assign_attrs(scene=scene_text.write(scene))


def _along_load(dataset: xr.Dataset) -> xr.Dataset:
    count = dataset.sizes["state"] - 1
    dataset = dataset.drop_vars(["load", "load_factor", "step"], errors="ignore")
    if count < 2:
        alone = {name: dataset.variables[name] for name in _UNDER_LOAD if name in dataset}
        dataset = dataset.assign(
            {name: one.set_dims(("load", *one.dims))[:count] for name, one in alone.items() if "load" not in one.dims}
        )
    dataset = dataset.assign_coords(load_coordinates(dataset["state_load_factor"].values[1:].tolist()))
    if not {"floor_force", "floor_force_rest"} <= set(dataset.variables):
        return dataset  # which is refused
    change = dataset["floor_force"].values - dataset["floor_force_rest"].values
    return dataset.assign(floor_force_change=described("floor_force_change", change))


def _with_events(dataset: xr.Dataset) -> xr.Dataset:
    """Lost equilibria, which those versions wrote of the whole programme together, as events on the way to a state."""
    if not any(name in dataset for name in _CROSSINGS):
        return dataset
    for name in _CROSSINGS:
        if name not in dataset:
            raise ResultError(f"is not a whole result: variable {name} is missing")
    stretches = [sorted(ends) for ends in pairwise(dataset["state_load_factor"].values.tolist())]
    found: list[tuple[int, Event]] = []
    state = 1
    lost: Any = zip(*(dataset[name].values.tolist() for name in _CROSSINGS), strict=True)
    for start, until, moved, reason in lost:
        # they are in order: each is on the first stretch, from that of the one before on, that holds its load
        while state < len(stretches) and not stretches[state - 1][0] <= start < stretches[state - 1][1]:
            state += 1
        found.append((state, Event(start, "jump", until=until, displacement=moved, reason=str(reason))))
    return dataset.drop_vars(_CROSSINGS).assign(described_events(found))
