"""What the stored datasets hold: the table of ``data/README.md``."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from granular_response.store import files as store

from .markdown import table

#: The lines between these marks of the document are made.
BLOCK = "datasets"


def markdown(folder: Path) -> str:
    """A row for each dataset of each file of ``folder``.

    Raises
    ------
    granular_response.store.files.StoreError
        If a dataset cannot be read.
    """
    files = sorted(folder.glob("*.nc"))
    rows = [_row(f"{path.stem}/{name}", data) for path in files for name, data in store.read(path).items()]
    return table(("dataset", "dimensions", "variables (units)"), rows)


def _row(name: str, data: xr.Dataset) -> tuple[str, str, str]:
    sizes = ", ".join(f"{dimension} {size}" for dimension, size in data.sizes.items())
    variables = ", ".join(_with_unit(str(variable), data[variable]) for variable in data.data_vars)
    return f"`{name}`", sizes, variables


def _with_unit(name: str, variable: xr.DataArray) -> str:
    unit = variable.attrs.get("units", "1")
    return f"`{name}`" if unit == "1" else f"`{name}` ({unit})"
