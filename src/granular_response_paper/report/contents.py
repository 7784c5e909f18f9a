"""What the stored datasets hold: the table of ``data/README.md``."""

from __future__ import annotations

from pathlib import Path

from granular_response.store import files as store

from .markdown import table

#: The lines between these marks of the document are made.
BLOCK = "datasets"


def markdown(folder: Path) -> str:
    """A row for each dataset of each file of ``folder``. Raises StoreError if one cannot be read."""
    rows = []
    for path in sorted(folder.glob("*.nc")):
        for name, data in store.read(path).items():
            sizes = ", ".join(f"{dimension} {size}" for dimension, size in data.sizes.items())
            units = {variable: one.attrs.get("units", "1") for variable, one in data.data_vars.items()}
            variables = (f"`{name}`" if unit == "1" else f"`{name}` ({unit})" for name, unit in units.items())
            rows.append((f"`{path.stem}/{name}`", sizes, ", ".join(variables)))
    return table(("dataset", "dimensions", "variables (units)"), rows)
