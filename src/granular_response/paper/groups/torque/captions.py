"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene, force=parameters.force, angle=parameters.angle, torque=parameters.torques)
    return {
        "fig18_torque": Caption(
            "Forces that an oblique force on one disk adds, for several torques on the same disk and packing; the "
            "effect of gravity is subtracted. Line widths and lengths are proportional to the force.",
            "Force chains that lead from a disk on top obliquely down, a panel for each torque.",
            given,
        ),
        "fig18_torque_reach": Caption(
            "(g), (h) How far the torque changes the added forces and the stress, against the distance from the load.",
            "Curves that fall with the distance from the load, one for each torque.",
            given,
        ),
    }
