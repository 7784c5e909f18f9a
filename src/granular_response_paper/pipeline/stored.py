"""The stored datasets of a group, for the stages that follow its simulations."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from granular_response.store import files as store
from granular_response_paper.pipeline import data_path
from granular_response_paper.registry import GroupError


def datasets(group: str, path: Path | None = None) -> tuple[Path, dict[str, xr.Dataset]]:
    """The file with a group's datasets, by default the one where they are kept, and what it holds.

    Raises GroupError if they are those of another group, StoreError if they cannot be read.
    """
    path = path or data_path(group)
    found = store.read(path)
    stored = store.read_attributes(path).get("group")
    if stored != group:
        what = f"those of {stored}" if stored else "not those of a figure group"
        raise GroupError(f"{path}: holds datasets of another kind, {what}, must be those of {group}")
    return path, found
