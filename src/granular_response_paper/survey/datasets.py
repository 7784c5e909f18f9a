"""Blocks of the survey as they are stored."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.store import files as store
from granular_response.store.variables import variable
from granular_response_paper.ensembles import NOT_REACHED

#: What makes a case of the survey, but for its forces and the number of its realizations.
PREPARED = ("polydispersity", "friction", "wall_friction", "lattice_constant", "gravity_ramp")


def gravity_ramp(each: Sequence[str]) -> xr.Variable:
    """How gravity grows in each case of a block."""
    return variable("case", each, "time in sqrt(radius/g) over which gravity grows; empty: it acts at once")


def read(folder: Path, blocks: Sequence[str]) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles`` and ``packings`` with the cases of all ``blocks``, in their order; of a case that several
    have, the first.

    Where a case has fewer realizations, forces or disks on the floor than another one, nan or NOT_REACHED fill it up.
    Raises StoreError if a file cannot be read.
    """
    found = [store.read(folder / f"{block}.nc") for block in blocks]
    return {name: _joined([one[name] for one in found]) for name in ("ensembles", "packings")}


def usual(data: xr.Dataset) -> xr.Dataset:
    """The cases with the initial lattice of the first one, on which gravity acts at once."""
    start = data["lattice_constant"].values
    return data.isel(case=(start == start[0]) & (data["gravity_ramp"].values == ""))


def _joined(parts: list[xr.Dataset]) -> xr.Dataset:
    sizes = {d: max(part.sizes.get(d, 0) for part in parts) for one in parts for d in one.sizes if d != "case"}

    def filled(variable: xr.Variable) -> xr.Variable:
        fill: Any = NOT_REACHED if variable.dtype.kind == "i" else "" if variable.dtype.kind in "UO" else np.nan
        missing = {d: (0, sizes[d] - n) for d, n in variable.sizes.items() if d != "case"}
        return variable.pad(missing, constant_values=fill)

    # blocks that do not say how gravity grows are those in which it acts at once
    at_once = [{"gravity_ramp": gravity_ramp([""] * part.sizes["case"])} for part in parts]
    said = [part.assign_coords({**one, **part.coords}) for part, one in zip(parts, at_once, strict=True)]
    variables = dict(said[0].variables)
    for name, first in variables.items():
        if "case" in first.dims:
            variables[name] = xr.Variable.concat([filled(part.variables[name]) for part in said], "case")
    cases = list(zip(*(variables[name].values.tolist() for name in PREPARED), strict=True))
    kept = [k for k, case in enumerate(cases) if cases.index(case) == k]
    return xr.Dataset(variables, attrs=parts[0].attrs).set_coords(list(said[0].coords)).isel(case=kept)
