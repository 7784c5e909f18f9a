"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "fig16s_symmetry_breaking": Caption(
            "Where the symmetry of the floor response is lost: (c) asymmetry after loading to one force, (d) after "
            "loading of copies of the packing, (e), (f) responses.",
            "Plots of the asymmetry against the force and of lopsided responses.",
            of_scene(parameters.scene),
        ),
    }
