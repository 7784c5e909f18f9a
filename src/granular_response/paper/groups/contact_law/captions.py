"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    panels = ", ".join(f"({chr(ord('a') + k)}) µ = {mu:g}" for k, mu in enumerate(parameters.friction))
    return {
        "contact_law": Caption(
            "Not in the paper: Sec. III.B says that measurements on its disks gave a force that grows as the overlap "
            "to the power 3/2, and that a linear law describes it well. Floor response with the linear law (lines) "
            "and with the 3/2 law (symbols), whose force is the same at the mean overlap of the slab at rest, and "
            f"their largest difference per largest response: {panels}. Without friction the disks of a row of the 3/2 "
            "slab bear almost nothing along x: it has several equilibria, and little decides which one is met.",
            "Three panels on one scale. Without friction symbols and lines differ widely, with friction 1 they nearly "
            "agree.",
            of_scene(parameters.scene, force=parameters.forces, friction=parameters.friction),
        )
    }
