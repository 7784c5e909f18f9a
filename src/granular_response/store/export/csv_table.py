"""A CSV table of disks, in the columns that ``packing: {kind: file}`` reads; every digit is kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from .frames import mark


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The file as bytes."""
    state = dataset.isel(state=-1)
    columns = [*state["position"].values.T, state["radius"].values, state["mass"].values]
    rows = [",".join(map(repr, values)) for values in np.column_stack(columns).tolist()]
    head = [f"# {mark(dataset)}, load factor {float(state['state_load_factor'])!r}"]
    return {path: ("\n".join([*head, "x,z,radius,mass", *rows]) + "\n").encode("ascii")}
