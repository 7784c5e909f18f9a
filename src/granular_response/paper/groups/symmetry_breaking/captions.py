"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, WEIGHT, Caption, of_scene, values

from .draw import PAPER
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    copies, held = parameters.copies, parameters.held
    ramps = sorted({protocol.ramp_time for protocol in parameters.protocols})
    steps = sorted({protocol.time_step for protocol in parameters.protocols}, reverse=True)
    forces = sorted({float(force) for force in datasets["runs"]["force"].values})
    text = (
        "Not in the paper: the loss of symmetry of Fig. 16 at large friction, where it begins and to which side. (c) "
        "Asymmetry of the floor response against the force of one load each, by dynamics with ramps that last "
        f"{values(ramps)} sqrt(R/g), full symbols with the time step {steps[0]:g}, hollow ones with {steps[-1]:g}; "
        f"crosses: states of the quasi-static path, displaced at random by {held.displacement:g} {RADIUS} and "
        f"settled again. Dotted: {PAPER:g} {WEIGHT}, from which the paper sees asymmetric responses. (d) Floor "
        f"response under {copies.force:g} {WEIGHT} of copies of the packing that differ by the numbers of the disks "
        f"or by random displacements of {copies.displacement:g} {RADIUS}: rounding decides the side."
    )
    if datasets["states"].sizes["state"] == 3:
        text += (
            " (e), (f) Contacts in the central third of the slab at the last symmetric and the first asymmetric "
            f"force of the ramp that lasts {parameters.protocols[0].ramp_time:g}: thin lines are unchanged, thick "
            "ones opened, and the marked ones are near the Coulomb limit. Arrow and circle: the force and its disk; "
            "the line below is the floor."
        )
    return {
        "fig16s_symmetry_breaking": Caption(
            text,
            "The asymmetry jumps by orders of magnitude, at a smaller force for the slower ramp. Responses of copies "
            "are mirror images of each other. Contacts that open, first symmetric, then not.",
            of_scene(parameters.scene, force=forces),
        ),
    }
