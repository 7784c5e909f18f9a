"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .draw import PAPER
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    events = datasets["events"]
    bracket = f"{float(events['low'].min()):.3g} to {float(events['high'].max()):.3g}"
    half_plane, simulated = PAPER
    return {
        "fig10_stiffness_ratio": Caption(
            "Ordered slabs with large friction. (a) Floor response for several k_T/k_N: two peaks at small ones. (b) "
            "The same of elastic bodies without horizontal springs, of the same colours and dashes: slab on a smooth "
            "floor and, with symbols, the same depth in a half plane. (c) Depth of the dip at x = 0 per largest "
            f"response. Grey: {bracket}, where the simulated response changes from two peaks over a plateau to one; "
            f"the inset enlarges it. Dotted: the crossover of the paper's half plane "
            f"({half_plane:g}) and of its simulations ({simulated:g}).",
            "Responses that go from two high peaks to one as the ratio grows, in simulation, elastic slab and "
            "elastic half plane, and the depth of the dip, which vanishes near 0.3 in all three.",
            of_scene(parameters.scene, force=parameters.force, stiffness_ratio=parameters.ratios),
        ),
        "fig11_spring_model": Caption(
            "The spring model behind Fig. 10: a triangular lattice whose bonds have a normal spring k_n along the "
            "line of centres and a tangential spring k_t across it, with index 1 for horizontal and 2 for oblique "
            "bonds. Drawn, not computed: disks are smaller than they are, so that the springs are seen.",
            "Drawing of three disks joined by coils along their bonds and, on rigid arms, across them.",
        ),
    }
