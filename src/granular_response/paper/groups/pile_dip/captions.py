"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene)
    return {
        "fig17_pile": Caption(
            "Piles of equal disks under gravity, without friction on the left and with it on the right. (a), (b) "
            "Contact forces; lengths and widths of the lines are proportional to the force, but none is thinner than "
            "a hairline. (c), (d) Vertical stress, coarse-grained with a Gaussian; the contours are the white lines "
            "of the colour scale, and the broken line is the hull of the disks. Hatched: the layer of one width w at "
            "the floor, in which part of the Gaussian lies outside the pile, so that the stress falls short. (e), "
            "(f) Contacts: lines join the centres of disks that touch. Floor and side walls are grey. The parameters "
            "are those with friction; without it all others are the same.",
            "Two piles beside each other, three pictures of each. Without friction the stress has two maxima beside "
            "the middle and the lowest row pushes against the side walls; with friction it has one maximum in the "
            "middle.",
            {**given, "width": parameters.stress_width},
        ),
        "fig17_pile_profiles": Caption(
            f"Not in the paper. (g) Vertical stress at the height {parameters.dip_height:g} {RADIUS}, (h) forces of "
            "single disks on the floor. Without friction there are two minima of the energy, mirror images of each "
            "other.",
            "Two plots against the horizontal position. Without friction stress and floor force dip in the middle, "
            "with friction they are largest there.",
            {**given, "width": parameters.stress_width},
        ),
    }
