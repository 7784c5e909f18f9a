"""What every dataset of a figure group says of itself."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.store.result import UNITS
from granular_response.store.variables import variable


def labelled(datasets: dict[str, xr.Dataset], scene: Scene | None = None) -> dict[str, xr.Dataset]:
    """The datasets with their system of units, and the scene that they began with."""
    for dataset in datasets.values():
        dataset.attrs.update(({"scene": scene.to_yaml()} if scene else {}) | {"units": UNITS})
    return datasets


def stress_components(dims: Sequence[str], stress: NDArray, unit: str, of: str = "") -> dict[str, xr.Variable]:
    """The four components of ``stress`` (..., 2, 2), force first, as variables ``stress_xx`` to ``stress_zz``."""
    return {
        f"stress_{force}{branch}": variable(
            dims, stress[..., a, b], f"stress component{of}, force along {force}, branch along {branch}, {unit}"
        )
        for a, force in enumerate("xz")
        for b, branch in enumerate("xz")
    }
