"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "preparation": Caption(
            "Not in the paper: the same slab prepared in several ways. (a) to (f) Forces between which each event "
            "comes, against friction, a symbol for each way; an arrow: not up to there. Rough: the walls have the "
            "friction of the disks; all others are smooth.",
            "Six panels on one scale, an event in each, with the forces at which it comes side by side for every "
            "preparation.",
            of_scene(
                parameters.scene,
                force=parameters.forces,
                friction=sorted({part.friction for part in parameters.parts}),
                wall_friction=None,
            ),
        )
    }
