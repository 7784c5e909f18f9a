"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene, force=parameters.force, angle=parameters.angle, torque=parameters.torques)
    last = "abcdefgh"[len(parameters.torques) - 1]
    return {
        "fig18_torque": Caption(
            f"(a) to ({last}) Contact forces that an oblique force on one disk of a slightly polydisperse slab adds, "
            "for several clockwise torques on the same disk of the same packing. The effect of gravity is subtracted "
            "as a vector. The central third of the upper half of the slab is shown. Lengths and widths of the lines "
            "are proportional to the force, the same in all panels, as the key in each says, but none is thinner "
            "than a hairline. Circle and straight arrow: the disk and the force, bent arrow: the torque.",
            "Six pictures of disks with force chains that lead obliquely down from a disk on top. The torque gathers "
            "two chains in one along the force.",
            given,
        ),
        "fig18_torque_reach": Caption(
            "Not in the paper: how far the torque reaches. Change by the torque of (g) the contact forces, (h) the "
            "coarse-grained stress tensor and (i) its antisymmetric part, in rings around the loaded disk: the sum "
            "of the magnitudes per sum of those that the force adds without torque, against the mean distance of the "
            "ring.",
            "Three plots on one logarithmic scale. Curves for growing torques lie above each other and fall with the "
            "distance, the antisymmetric stress by far the fastest.",
            {**given, "torque": parameters.torques[1:], "width": parameters.stress_width},
        ),
    }
