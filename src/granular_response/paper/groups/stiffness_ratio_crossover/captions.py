"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene, force=parameters.force, stiffness_ratio=parameters.ratios)
    return {
        "fig10_stiffness_ratio": Caption(
            "Floor response for several ratios of tangential to normal stiffness, two peaks at small ones: (a) "
            "simulated, (b) of elastic bodies without horizontal springs, (c) depth of the dip at x = 0.",
            "Responses that go from two peaks to one, and the depth of the dip between the peaks against the ratio.",
            given,
        ),
        "fig11_spring_model": Caption(
            "The spring model: a triangular lattice with normal and tangential springs, horizontal and oblique ones "
            "apart.",
            "Drawing of disks joined by springs.",
        ),
    }
