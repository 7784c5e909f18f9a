"""A CSV table of the closed contacts of one state; every digit is kept."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from ..contact_table import contact_table
from ..result import state_from


def files(dataset: xr.Dataset, path: Path) -> dict[Path, bytes]:
    """The file as bytes."""
    table = contact_table(state_from(dataset, -1), dataset["radius"].values)
    return {path: table.to_csv().encode("ascii")}
