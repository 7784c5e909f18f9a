"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "sensitivity": Caption(
            "How much each reading of the paper changes the floor response, one changed at a time: largest difference "
            "from the reference per applied force. The table of readings has the numbers.",
            "Two marks for each reading on a logarithmic axis, over several powers of ten.",
            of_scene(parameters.scene, force=parameters.force, friction=parameters.friction),
        )
    }
