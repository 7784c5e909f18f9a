"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene)
    return {
        "fig17_pile": Caption(
            "A pile under gravity without and with friction: (a), (b) contact forces, (c), (d) vertical stress, "
            "coarse-grained with a Gaussian, (e), (f) contact network. The parameters are those with friction.",
            "Two piles beside each other, three pictures of each: force chains, a map of the stress, the contacts.",
            {**given, "width": parameters.stress_width},
        ),
        "fig17_pile_profiles": Caption(
            f"(g) Stress at the height {parameters.dip_height:g} R, (h) forces on the floor.",
            "Two plots against the horizontal position, of stress and of floor force.",
            given,
        ),
    }
