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
    units = {variable: one.attrs.get("units", "1") for variable, one in data.data_vars.items()}
    variables = (f"`{variable}`" if unit == "1" else f"`{variable}` ({unit})" for variable, unit in units.items())
    return f"`{name}`", sizes, ", ".join(variables)
