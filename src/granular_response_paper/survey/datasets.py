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

    Where a case has fewer realizations, forces or disks on the floor than another one, nan or NOT_REACHED fill it up.
    What one of the files lacks is left out.

    Raises
    ------
    granular_response.store.files.StoreError
        If a file cannot be read.
    """
    found = [store.read(folder / f"{block}.nc") for block in blocks]
    return {name: _joined([one[name] for one in found]) for name in ("ensembles", "packings")}


def _joined(parts: list[xr.Dataset]) -> xr.Dataset:
    sizes = {
        name: max(int(part.sizes.get(name, 0)) for part in parts)
        for name in {str(name) for part in parts for name in part.sizes} - {"case"}
    }
    variables = {}
    for name in [name for name in parts[0].variables if all(name in part.variables for part in parts)]:
        first = parts[0].variables[name]
        filled = []
        for part in parts:
            variable = part.variables[name]
            fill: Any = NOT_REACHED if variable.dtype.kind == "i" else "" if variable.dtype.kind in "UO" else np.nan
            missing = {d: (0, sizes[str(d)] - n) for d, n in variable.sizes.items() if d != "case"}
            filled.append(variable.pad(missing, constant_values=fill))
        variables[name] = xr.Variable.concat(filled, "case") if "case" in first.dims else first
    return xr.Dataset(variables, attrs=parts[0].attrs).set_coords([str(name) for name in parts[0].coords])
