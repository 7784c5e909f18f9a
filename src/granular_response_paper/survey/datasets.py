"""Blocks of the survey as they are stored."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response.store import files as store
from granular_response_paper.ensembles import NOT_REACHED


def read(folder: Path, blocks: Sequence[str]) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles`` and ``packings`` with the cases of all ``blocks``, in their order.

    Where a case has fewer realizations, forces or disks on the floor than another one, nan or NOT_REACHED fill it up;
    a text that a block does not have is empty.
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

    variables = {name: one for part in parts for name, one in part.variables.items()}
    for name, one in variables.items():
        if "case" in one.dims:
            unsaid = [xr.Variable("case", np.full(part.sizes["case"], ""), one.attrs) for part in parts]
            each = [part.variables.get(name, empty) for part, empty in zip(parts, unsaid, strict=True)]
            variables[name] = xr.Variable.concat([filled(own) for own in each], "case")
    return xr.Dataset(variables, attrs=parts[0].attrs).set_coords({name for part in parts for name in part.coords})
