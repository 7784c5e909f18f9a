"""What every dataset of a figure group says of itself."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.solvers.solution import Solution
from granular_response.store.result import UNITS, to_dataset
from granular_response.store.variables import variable

#: What pictures of a result take of its dataset, and the part of its certificates that says whether it is balanced.
PICTURED = (
    "state_load_factor", "position", "angle", "radius", "contact_disk", "contact_partner", "contact_status",
    "contact_force", "wall_disk", "wall_index", "wall_force", "loaded_disk", "applied_load", "total_force",
    "floor_response", "certificate_force_residual",
)  # fmt: skip


def labelled(datasets: dict[str, xr.Dataset], scene: Scene | None = None) -> dict[str, xr.Dataset]:
    """The datasets with their system of units, and the scene that they began with."""
    for dataset in datasets.values():
        dataset.attrs.update(({"scene": scene.to_yaml()} if scene else {}) | {"units": UNITS})
    return datasets


def pictured(solution: Solution) -> xr.Dataset:
    """The states of a solution, at rest and under its loads, as ``granular_response.plot`` draws them."""
    data, scene = to_dataset(solution), solution.problem.scene
    return data[[name for name in PICTURED if name in data]].assign(
        friction=variable((), scene.contact.friction, "coefficient of friction between disks"),
        polydispersity=variable((), scene.packing.model_dump()["polydispersity"], "delta: spread of the radii"),
    )


def stress_components(dims: Sequence[str], stress: NDArray, unit: str, of: str = "") -> dict[str, xr.Variable]:
    """The four components of ``stress`` (..., 2, 2), force first, as variables ``stress_xx`` to ``stress_zz``."""
    return {
        f"stress_{force}{branch}": variable(
            dims, stress[..., a, b], f"stress component{of}, force along {force}, branch along {branch}, {unit}"
        )
        for a, force in enumerate("xz")
        for b, branch in enumerate("xz")
    }
