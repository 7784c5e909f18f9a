"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, Caption, values

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    poisson = float(datasets["predictions"]["poisson_ratio"])
    return {
        "fig01_predictions": Caption(
            "Predictions for the pressure on the floor under a vertical force on top of a slab of height h, times h "
            "over the force. (a) Elliptic: isotropic elasticity, a slab on a rough or a smooth rigid floor, and a "
            f"half plane at the same depth; Poisson's ratio {poisson:.3f}, that of the lattice at k_T/k_N = "
            f"{parameters.stiffness_ratio:g}. (b) Hyperbolic: two rays at {parameters.ray_angle:g}° to the vertical, "
            "that of the lattice, which spread diffusively, the square of their width the depth times "
            f"{parameters.diffusion_length:g} {RADIUS}; h = {values(parameters.depths)} {RADIUS}.",
            "Two plots against x/h on one scale. (a) One broad peak in the middle for each of three bodies, highest "
            "for the smooth floor, lowest for the half plane. (b) Two narrow peaks, narrower and higher for the "
            "deeper slab.",
        )
    }
