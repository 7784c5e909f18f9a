"""One scene with many values of its keys, or prepared in several ways, as one labelled dataset."""

from __future__ import annotations

import functools
import itertools
import json
import os
import platform
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from importlib import metadata
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr
from pandas import MultiIndex

from .. import __version__
from ..errors import SolveError, require
from ..scene import Preparation, Scene, SceneError, Taps
from ..scene.base import Description
from ..scene.errors import show
from ..scene.given import plain, unordered
from ..solvers.solution import Solution, checked_problem, load_programme, solve_scene
from ..store.files import CHARACTERS, TEXT
from ..store.result import COORDINATES
from ..sweeps.errors import SweepError, interrupted
from ..sweeps.memory import MISSING, Memory
from ..sweeps.resources import KEPT, current, using
from ..sweeps.tasks import Progress, map_tasks
from .result import Result, described
from .terminal import shown

#: Dimensions that lose labels that differ, for another coordinate: steps of a load programme have none in common with
#: those of another, and floor disks lie in order along x, which their indices do not.
_KEPT_AS = {"load": "load_factor", "floor_disk": "floor_disk_index"}
#: The dimension of floor disks in a sweep that joins them by their numbers, where others are counted from the left.
_BY_NUMBER = "floor_disk_number"

#: The dimension of all combinations, before they are a grid.
_PLACE = "combination of keys"

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


def floor_response(result: Result) -> xr.DataArray:
    """The measure of a sweep that names none."""
    return result.floor_response


def sweep(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    axes: Mapping[str, Iterable[Any]],
    measure: Callable[[Result], Any] = floor_response,
    *,
    load_factors: Sequence[float] | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: Progress | bool = True,
) -> xr.Dataset:
    """Solve a scene for every combination of parameter values, and return one labelled dataset.

    Call it under ``if __name__ == "__main__":`` in a script, since worker processes import the script.

    Parameters
    ----------
    scene : the common scene: a scene, nested mappings, or the path of a scene file.
    axes : values of each scene parameter: ``{"contact.friction": [0, 0.2], "packing.realization": range(20)}``.
        ``granular-response keys`` lists the parameters.
    measure : function of a :class:`Result`, called where it was solved; returns a number, a ``DataArray``, a
        ``Dataset``, or a mapping of names to numbers, arrays and ``DataArray``. A lambda or a function of a notebook is
        allowed. By default the floor response.
    load_factors : load factors at which states are stored; those of the scene if left out.
    workers : local processes; all cores if left out, this process if 1.
    executor : a ``concurrent.futures.Executor`` in place of local processes, as of :func:`map_tasks`.
    checkpoint : folder in which each solution is stored, so that an interrupted sweep continues and another ``measure``
        reuses the solutions. **It must be your own folder**, and all workers must reach it. A stored solution is reused
        if the scene, its files (disks, springs), this package, the installed numba, numpy, scipy and xarray, and the
        modules of user-defined laws or packings, with all of your own that they import, are unchanged. Not detected:
        files that such a law or packing opens by itself, unless the packing's property ``files`` lists them, and
        environment variables. Reading a solution runs no code; files of another owner and damaged files are recomputed.
    progress : a line on the terminal, or in a notebook; False for none, or a function that is called as
        ``progress(done, total, what)``.

    Returns
    -------
    A dataset with one dimension for each parameter, in the order of ``axes``, followed by the dimensions of the
    measure.

    * A dimension is named by the last part of its key (``friction``, ``realization``), or by the whole key with ``_``
      if two keys end alike. Its coordinate has the values, with the attribute ``key``; values that are neither numbers
      nor text are numbered in the given order.
    * Variables whose length differs between results are padded with NaN. Floor disks are then numbered from the left;
      ``floor_disk_index`` gives their index in the packing.
    * If load programmes differ, ``load`` has no labels: ``step`` numbers the loads, and ``load_factor`` has their
      values for each combination.
    * Attributes: those that all results share, and ``scene`` (with its seed), ``axes``, ``load_factors``, the name of
      the ``measure``, ``package_version`` and ``versions``.
    * A combination without equilibrium is NaN. The variable ``error`` has its message (empty for the others), and a
      warning gives their number. Warnings of :func:`solve` appear once, with the number of combinations and the
      first of them.

    Raises
    ------
    granular_response.SceneError
        For a key, a value or load factors that are not allowed, before anything is solved.
    ValueError
        If ``axes`` is not a mapping, or an axis is not a list of values, is empty or contains a value twice.
    granular_response.SweepError
        If ``measure`` raises an error or returns another type, no combination has an equilibrium, or workers fail.

    Examples
    --------
    >>> small = gr.Scene(packing=gr.Slab(layers=3, disks_per_row=7), loads=[gr.Load(disk="top-centre", force=(0, -1))])
    >>> found = gr.sweep(small, {"contact.friction": [0.0, 0.2]}, workers=1)
    >>> found["floor_response"].dims
    ('friction', 'load', 'floor_disk')
    """
    base = described(scene)
    values = _values(axes)
    require(values, "axes: must have one key or more")
    programme = {} if load_factors is None else {"protocol.load_factors": load_programme(load_factors)}
    points = [dict(zip(values, point, strict=True)) for point in itertools.product(*values.values())]
    require(not (programme.keys() & values.keys()), "load_factors: is an axis too, must be one of the two")
    scenes = [base.updated({**point, **programme}) for point in points]
    for each in scenes:
        checked_problem(each)
    folder = checkpoint or current().checkpoint
    memory = Memory(folder, states=True) if folder else None
    kept = sum(memory.has(memory.name(_solved, one)) for one in scenes) if memory else 0
    task = functools.partial(_measured, measure=measure, memory=memory)
    with using(checkpoint=None), shown(progress) as report:
        if kept and report:
            report(kept, len(scenes), KEPT)
        try:
            found = map_tasks(task, scenes, workers=workers, executor=executor, progress=report, what="scenes")
        except KeyboardInterrupt:
            if not memory:
                raise
            kept = sum(memory.has(memory.name(_solved, one)) for one in scenes)
            raise interrupted(f"{kept} of {len(scenes)} solutions are kept in {folder}") from None
    remarks = Counter(remark for _, remarks in found for remark in remarks)
    for remark, count in remarks.items():
        first = next(point for point, (_, own) in zip(points, found, strict=True) if remark in own)
        which = ", ".join(f"{key} = {show(value)}" for key, value in first.items())
        which = "" if count == len(found) else f" ({'the first: ' if count > 1 else ''}{which})"
        warnings.warn(f"{count} of {len(found)} combinations{which}: {remark}", stacklevel=2)
    gridded = _gridded(values, [measured for measured, _ in found])
    return gridded.assign_attrs(_provenance(base.updated(programme), values, measure))


def preparations(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    ways: Mapping[str, Preparation | Mapping[str, Any]] = WAYS,
    measure: Callable[[Result], Any] = floor_response,
    *,
    load_factors: Sequence[float] | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: Progress | bool = True,
) -> xr.Dataset:
    """The response of a scene under several preparations, with its band over them.

    With friction the initial equilibrium depends on how gravity was applied. This matters more than most parameters.

    Parameters
    ----------
    ways : preparations by name: a ``Preparation``, or a mapping of the keys that differ from the scene's. By default
        gravity applied instantaneously (the paper's), ramped over 20, 100 and 500 sqrt(R/g), frictionless preparation,
        and ten taps of 0.5 g after slow gravity.
    scene, measure, load_factors, workers, executor, checkpoint, progress : as of :func:`sweep`.

    Returns
    -------
    The dataset of :func:`sweep` with the dimension ``preparation`` and the variable ``loaded_disk``. Each numeric
    variable ``v`` has a band over preparations, from ``v_low`` to ``v_high``; preparations without an equilibrium are
    left out. If different disks reach the floor, ``floor_disk`` has their indices, in the order of x, so that a band
    belongs to one disk.

    Raises the errors of :func:`sweep`, and granular_response.SceneError for an entry that is not a preparation or is
    given twice. Warns (UserWarning) if loads act on different disks in different preparations.

    Examples
    --------
    >>> small = gr.Scene(packing=gr.Slab(layers=3, disks_per_row=7), loads=[gr.Load(disk="top-centre", force=(0, -1))])
    >>> ways = {"at once": {}, "tapped": gr.Preparation(taps=gr.Taps(number=1))}
    >>> found = gr.preparations(small, ways, workers=1)
    >>> float((found["floor_response_high"] - found["floor_response_low"]).max().round(3))
    0.006
    """
    rule = f"ways = {show(ways)}: must be a mapping of names to preparations"
    require(isinstance(ways, Mapping) and ways and all(isinstance(name, str) for name in ways), rule, SceneError)
    base, chosen = described(scene), []
    for name, way in ways.items():
        try:
            chosen.append(base.updated({"preparation": way}).preparation)
        except SceneError as error:
            raise SceneError(f"ways[{name!r}]: {error}") from None
        if (first := chosen.index(chosen[-1])) < len(chosen) - 1:
            twin = list(ways)[first]
            raise SceneError(f"ways[{name!r}]: is the same as {twin!r}; keys that are left out are those of the scene")
    options: dict[str, Any] = {"load_factors": load_factors, "workers": workers, "executor": executor}
    options |= {"checkpoint": checkpoint, "progress": progress}
    found = sweep(base, {"preparation": chosen}, functools.partial(_noted, measure=measure), **options)
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


def _provenance(scene: Scene, values: Mapping[str, list[Any]], measure: Callable[[Result], Any]) -> dict[str, str]:
    """What a sweep was made from, and by what: texts, as netCDF takes them."""
    while isinstance(measure, functools.partial):
        measure = measure.keywords.get("measure", measure.func)
    named = measure if hasattr(measure, "__qualname__") else type(measure)
    own = "protocol.load_factors" in values
    versions = {name: metadata.version(name) for name in ("numba", "numpy", "scipy", "xarray")}
    return {
        "package": "granular_response",
        "package_version": __version__,
        "versions": json.dumps({"python": platform.python_version(), **versions}),
        "scene": scene.to_yaml(),
        "scene_note": "what all combinations have in common; the axes change it",
        "axes": json.dumps(values, default=_as_json),
        **({} if own else {"load_factors": json.dumps(scene.protocol.load_factors)}),
        "measure": f"{named.__module__}.{named.__qualname__}",
    }


def _as_json(value: Any) -> Any:
    return value.model_dump(mode="json") if isinstance(value, Description) else str(value)


def _noted(result: Result, *, measure: Callable[[Result], Any]) -> xr.Dataset:
    """What is measured, floor disks by their numbers, and which disks are loaded."""
    disks = xr.DataArray(result.loaded_disks, dims="load_point", attrs={"long_name": "disk of each load"})
    measured = as_dataset(measure(result)).assign(loaded_disk=disks)
    return measured.rename({name: _BY_NUMBER for name in measured.dims if name == "floor_disk"})


def _values(axes: Any) -> dict[str, list[Any]]:
    """The values of each key; raises ValueError for what is no axis."""
    require(isinstance(axes, Mapping), f"axes = {show(axes)}: must be a mapping of keys to lists of values")
    values = {}
    for key, given in axes.items():
        # text and mappings can be iterated over too, but by letters and by names
        rule = f"axes: {key} = {show(given)}, must be a list of values"
        require(not isinstance(given, (str, bytes, Mapping)) and np.iterable(given) and not unordered(given), rule)
        values[key] = list(plain(given))
        require(values[key], f"axes: {key} has no values, must have one or more")
        for k, value in enumerate(values[key]):
            if value in values[key][:k]:
                raise ValueError(f"axes: {key} has {show(value)} twice, must have different values")
    return values


def _measured(
    scene: Scene, *, measure: Callable[[Result], Any], memory: Memory | None
) -> tuple[xr.Dataset | str, list[str]]:
    """What is measured on a scene, or why it has no equilibrium, and the remarks on the solution."""
    name = memory.name(_solved, scene) if memory else None
    kept = memory.load(name) if memory else MISSING
    if isinstance(kept, tuple):  # states: the rest of a solution is made from the scene
        rest, *loaded = kept
        solved: Solution | str = Solution(scene, checked_problem(scene).with_loads(rest.position), rest, tuple(loaded))
    elif isinstance(kept, str):
        solved = kept
    else:
        solved = _solved(scene)
        if memory:
            made = solved if isinstance(solved, str) else (solved.rest, *solved.loaded)
            memory.save_result(name, made, _solved, scene)
    if isinstance(solved, str):
        return solved, []
    return as_dataset(measure(Result(solved))), solved.remarks


def _solved(scene: Scene) -> Solution | str:
    """The solution of a scene, or why it has no equilibrium."""
    try:
        return solve_scene(scene)
    except SolveError as error:
        return " ".join(str(error).split())


def as_dataset(measured: Any) -> xr.Dataset:
    """What a measure returned as a dataset."""
    if isinstance(measured, xr.Dataset):
        return measured
    if isinstance(measured, xr.DataArray):
        return measured.to_dataset(name=measured.name or "measure")
    if not isinstance(measured, Mapping):
        measured = {"measure": measured}
    variables = {}
    for name, value in measured.items():
        if isinstance(value, xr.DataArray):
            variables[name] = value
            continue
        array = np.asarray(value)
        if np.ma.is_masked(value) and array.dtype.kind in "biuf":  # what is missing is not what stands under the mask
            array = np.where(np.ma.getmaskarray(value), np.nan, array)
        if array.dtype.kind not in "biufcSU":
            kind = type(value).__name__
            raise TypeError(f"measure: {name} is a {kind}, must be a number, an array, a DataArray or a Dataset")
        variables[name] = xr.DataArray(array, dims=[f"{name}_{k}" for k in range(array.ndim)])
    return xr.Dataset(variables)


def _gridded(values: Mapping[str, list[Any]], found: Sequence[xr.Dataset | str]) -> xr.Dataset:
    """One dataset of those of all combinations, which are in the order of the product of ``values``."""
    errors = [one if isinstance(one, str) else "" for one in found]
    good = [place for place, one in enumerate(found) if not isinstance(one, str)]
    require(good, f"none of {len(found)} combinations has an equilibrium, the first: {errors[0]}", SweepError)
    results = [one for one in found if not isinstance(one, str)]
    names = _names(values)
    taken = {str(name) for one in results for name in (*one.variables, *one.dims)} & {*names.values(), "error"}
    if taken:
        raise SweepError(f"measure: {min(taken)} is the name of an axis, must be another one")
    measured, bare = _labelled_alike(results)
    same: dict[str, Any] = {"join": "outer", "compat": "equals", "combine_attrs": "override"}
    joined = xr.concat(measured, _PLACE, data_vars="all", coords="different", **same).drop_vars(bare, errors="ignore")
    joined = joined.assign_coords({_PLACE: good}).reindex({_PLACE: range(len(found))})
    grid = MultiIndex.from_product([range(len(given)) for given in values.values()], names=list(names.values()))
    gridded = joined.assign_coords(xr.Coordinates.from_pandas_multiindex(grid, _PLACE)).unstack(_PLACE)
    gridded = gridded.transpose(*names.values(), ...)
    objects = {name: one for name, one in gridded.variables.items() if one.dtype.kind == "O"}
    gridded = gridded.assign({name: one.copy(data=_without_objects(one.values)) for name, one in objects.items()})
    if "load" in bare:
        said = next((one["step"].attrs for one in results if "step" in one.coords), {})
        gridded = gridded.assign_coords(step=("load", np.arange(1, gridded.sizes["load"] + 1), said))
    gridded = gridded.assign_coords(
        {name: (name, _coordinate(values[key]), {"key": key}) for key, name in names.items()}
    )
    if any(errors):
        failed = [error for error in errors if error]
        said = {"long_name": "why there is no equilibrium"}
        gridded["error"] = (tuple(names.values()), np.array(errors).reshape([len(v) for v in values.values()]), said)
        warnings.warn(
            f"{len(failed)} of {len(found)} combinations have no equilibrium, see the variable error; the first: "
            f"{failed[0]}",
            stacklevel=3,
        )
    first, *others = (one.attrs for one in results)
    gridded.attrs = {k: v for k, v in first.items() if all(np.array_equal(v, np.asarray(one.get(k))) for one in others)}
    for one in gridded.variables.values():
        if one.dtype.kind in TEXT:
            one.encoding = dict(CHARACTERS)
    # as for a single result, sel() takes the factor, or the step where factors repeat or differ
    for name in ("load_factor", "step"):
        along = gridded.coords.get(name)
        if along is not None and along.dims == ("load",) and len(set(along.values.tolist())) == len(along):
            return gridded.set_xindex(name)
    return gridded


def _labelled_alike(results: Sequence[xr.Dataset]) -> tuple[list[xr.Dataset], set[Any]]:
    """Results that can be joined by labels, and the dimensions that have none of their own and are numbered."""
    plain, bare = [one.reset_index([name for name in one.xindexes if name not in one.dims]) for one in results], set()
    for dim in {dim for one in plain for dim in one.dims}:
        labels = [one.get_index(dim) if dim in one.coords else one.sizes.get(dim) for one in plain]
        if all(np.array_equal(np.asarray(one), np.asarray(labels[0])) for one in labels):
            continue
        if dim in _KEPT_AS or not any(dim in one.coords for one in plain):
            bare.add(dim)
            plain = [_numbered(one, dim) for one in plain]
        elif not all(dim not in one.coords or one.get_index(dim).is_unique for one in plain):
            raise SweepError(f"measure: {dim} has a label twice, must have different ones or the same in each result")
    return plain, bare


def _numbered(one: xr.Dataset, dim: Any) -> xr.Dataset:
    """With numbers along ``dim``, and what it had as labels in a coordinate of ``_KEPT_AS``."""
    kept = _KEPT_AS.get(dim)
    if kept and dim in one.coords and kept not in one.variables:
        one = one.assign_coords({kept: one[dim].variable.to_base_variable()})
    numbered = one.assign_coords({dim: np.arange(one.sizes[dim])}) if dim in one.dims else one
    return numbered.drop_vars("step", errors="ignore") if dim == "load" else numbered


def _without_objects(values: np.ndarray) -> np.ndarray:
    """Text or truth values with gaps as text, or as numbers."""
    text = any(isinstance(value, str) for value in values.flat)
    return np.where(values == values, values, "").astype(str) if text else values.astype(float)


def _names(values: Iterable[str]) -> dict[str, str]:
    """The dimension of each key: its last part, or all of it where a coordinate of a result or another key has that."""
    keys = list(values)
    last = [key.rpartition(".")[2] for key in keys]
    taken = COORDINATES | {end for end in last if last.count(end) > 1}
    return {key: key.replace(".", "_") if end in taken else end for key, end in zip(keys, last, strict=True)}


def _coordinate(values: Sequence[Any]) -> np.ndarray:
    """Values as a coordinate: numbers as numbers, text and numbers as text, others by their place."""
    found = plain(list(values))
    if all(type(value) is bool for value in found) or all(type(value) in (int, float) for value in found):
        return np.array(found)
    if all(isinstance(value, (bool, int, float, str)) for value in found):
        return np.array([str(value) for value in found])
    return np.arange(len(found))
