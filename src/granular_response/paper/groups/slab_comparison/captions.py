"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    cases = parameters.cases
    layers = sorted({n for case in cases for n in case.layers})
    return {
        "fig01b_slab_comparison": Caption(
            "Not in the paper: simulated slabs beside the elastic slab with their moduli and floor. (c) Floor "
            "pressure of a thin slab (open symbols) and of a deep one (small ones), each with its elastic slab. (d) "
            "Largest distance of the two, per largest response, as the number of layers grows; 8 wide: eight disks "
            "of a row for each layer; rough: as much friction on floor and walls as between disks; slow: gravity "
            "grows slowly. Two things keep packings from the elastic slab: beside smooth walls gravity opens "
            "contacts, which is felt in a narrow slab of any depth, and a sudden fall on a rough floor can open a "
            "row in the middle, as with 15 layers.",
            "(c) Symbols on two bell-shaped curves, the smooth floor's higher. (d) Distances that fall with the "
            "number of layers on logarithmic axes, but for one outlier at 15 layers.",
            of_scene(
                parameters.scene,
                force=parameters.force,
                friction=sorted({case.friction for case in cases}),
                wall_friction=sorted({case.friction if case.floor == "rough" else 0.0 for case in cases}),
                stiffness_ratio=parameters.scene.contact.stiffness_ratio,
                packing=f"slabs of {layers[0]} to {layers[-1]} layers",
            ),
        )
    }
