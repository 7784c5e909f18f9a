"""What every dataset of a figure group says of itself."""

from __future__ import annotations

import xarray as xr

from granular_response.scene import Scene
from granular_response.store.result import UNITS


def labelled(datasets: dict[str, xr.Dataset], scene: Scene | None = None) -> dict[str, xr.Dataset]:
    """The datasets with their system of units, and the scene that they began with."""
    for dataset in datasets.values():
        dataset.attrs.update(({"scene": scene.to_yaml()} if scene else {}) | {"units": UNITS})
    return datasets
