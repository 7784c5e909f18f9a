"""The response of a scene over preparations: with friction it depends on how the packing came to rest."""

from __future__ import annotations

import functools
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr

from ..scene import Preparation, Scene, SceneError, Taps
from ..scene.errors import show
from ..sweeps.tasks import Progress
from .result import Result, described
from .sweep import as_dataset, floor_response, sweep

#: The dimension of floor disks in a sweep that joins them by their numbers, where others are counted from the left.
_BY_NUMBER = "floor_disk_number"

#: Preparations that are compared unless others are given.
WAYS: Mapping[str, Preparation] = MappingProxyType(
    {
        "at once": Preparation(),
        "slow 20": Preparation(gravity="slow", ramp_time=20.0),
        "slow 100": Preparation(gravity="slow"),
        "slow 500": Preparation(gravity="slow", ramp_time=500.0),
        "without friction": Preparation(gravity="frictionless"),
        "tapped": Preparation(gravity="slow", taps=Taps()),
    }
)


def preparations(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    ways: Mapping[str, Preparation | Mapping[str, Any]] = WAYS,
    measure: Callable[[Result], Any] = floor_response,
    *,
    load_factors: Sequence[float] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: Progress | bool = True,
) -> xr.Dataset:
    """The response of a scene prepared in several ways, with its band over them.

    Unless the load is small, the way in which gravity was applied matters more than most parameters.

    Parameters
    ----------
    ways : by name, a ``Preparation`` or a mapping of keys that differ from that of the scene. If left out: gravity at
        once (the paper's), ramped over 20, 100 and 500 sqrt(R/g), a start without friction, and ten taps of 0.5 g after
        slow gravity.
    scene, measure, load_factors, workers, scheduler, checkpoint, progress : as of :func:`sweep`.

    Returns
    -------
    What :func:`sweep` returns, with the dimension ``preparation``, and ``loaded_disk``; and of each measured number
    that depends on it, ``..._low`` and ``..._high``, the ends of its band over preparations (those without an
    equilibrium left out). Where not the same disks reach the floor, ``floor_disk`` has their numbers, in their order
    along x, so that a band is that of one disk.

    Raises as :func:`sweep` does; SceneError for what is no preparation, or one that is given twice. Warns (UserWarning)
    where a load is on another disk in another preparation.

    Examples
    --------
    >>> small = gr.Scene(packing=gr.Slab(layers=3, disks_per_row=7), loads=[gr.Load(disk="top-centre", force=(0, -1))])
    >>> ways = {"at once": {}, "tapped": gr.Preparation(taps=gr.Taps(number=1))}
    >>> found = gr.preparations(small, ways, workers=1)
    >>> float((found["floor_response_high"] - found["floor_response_low"]).max().round(3))
    0.006
    """
    if not isinstance(ways, Mapping) or not ways or not all(isinstance(name, str) for name in ways):
        raise SceneError(f"ways = {show(ways)}: must be a mapping of names to preparations")
    base, chosen = described(scene), []
    for name, way in ways.items():
        try:
            chosen.append(base.updated({"preparation": way}).preparation)
        except SceneError as error:
            raise SceneError(f"ways[{name!r}]: {error}") from None
        if (first := chosen.index(chosen[-1])) < len(chosen) - 1:
            twin = list(ways)[first]
            raise SceneError(f"ways[{name!r}]: is the same as {twin!r}; keys that are left out are those of the scene")
    options: dict[str, Any] = {"load_factors": load_factors, "workers": workers, "scheduler": scheduler}
    noted = functools.partial(_noted, measure=measure)
    found = sweep(base, {"preparation": chosen}, noted, checkpoint=checkpoint, progress=progress, **options)
    found = found.assign_coords(preparation=("preparation", list(ways), found["preparation"].attrs))
    disks = found["loaded_disk"].values
    if len({tuple(one) for one in disks[np.isfinite(disks).all(axis=1)].tolist()}) > 1:
        said = ", ".join(f"{way}: {one.tolist()}" for way, one in zip(ways, disks, strict=True))
        cure = "name a disk by its number"
        warnings.warn(f"loads are on other disks in other preparations ({said}); {cure}", stacklevel=2)
    if _BY_NUMBER in found.dims:
        found = found.rename({_BY_NUMBER: "floor_disk"})
        if "x" in found.coords and "preparation" in found["x"].dims:
            found = found.isel(floor_disk=np.argsort(found["x"].mean("preparation").values))
    numbers = found.drop_vars("loaded_disk").data_vars
    over = {name: one for name, one in numbers.items() if "preparation" in one.dims and one.dtype.kind in "fiu"}
    low = {f"{name}_low": one.min("preparation", keep_attrs=True) for name, one in over.items()}
    high = {f"{name}_high": one.max("preparation", keep_attrs=True) for name, one in over.items()}
    return found.assign(low | high)


def _noted(result: Result, *, measure: Callable[[Result], Any]) -> xr.Dataset:
    """What is measured, floor disks by their numbers, and which disks are loaded."""
    disks = xr.DataArray(result.loaded_disks, dims="load_point", attrs={"long_name": "disk of each load"})
    measured = as_dataset(measure(result)).assign(loaded_disk=disks)
    return measured.rename({name: _BY_NUMBER for name in measured.dims if name == "floor_disk"})
