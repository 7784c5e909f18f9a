"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .draw import FORCES, LINEAR_UNTIL
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene)
    diameters = [2 * offset for offset in parameters.offsets]
    panels = ", ".join(f"({'abcdefgh'[k]}) d = {d:g} diameters" for k, d in enumerate(diameters))
    compared = (
        "Forces of single disks on the floor, not smoothed, per force of one load, in one realization of the "
        "disorder. Left, Right: the response to a load to the left or right of the middle of the top, (Left+Right): "
        "to both at once, (Left)+(Right): the sum of the two single ones. Arrows: the loads, their distance d being "
        f"{panels}. Figs. 23 and 24 share realization and scale."
    )
    found = {
        stem: Caption(
            compared,
            f"Four panels for growing distances under loads of {force:g}. Circles of the sum {how} the line of both "
            "loads; far apart the response has two peaks.",
            {**given, "force": force, "distance": [2.0 * d for d in diameters]},
        )
        for (stem, force), how in zip(FORCES.items(), ("lie on", "nearly lie on"), strict=True)
    }
    linear = datasets["linear_range"].sizes["realization"]
    found["fig24b_superposition_error"] = Caption(
        "Not in the paper: how far both loads at once are from the sum of each alone, root mean square relative to "
        "both, against the force for (e) the floor forces and (f) all contact forces, and (g) against the depth, for "
        "contacts between neighbouring rows. Means of the realizations with bands of one standard error. Black dots: "
        "change of the contact forces per force under a single load, relative to the smallest one. Grey band: where "
        f"the linear range of the middle half of {linear} realizations ends (response at x = 0, smoothed with w = "
        f"{parameters.width:g}, changed by {100.0 * parameters.tolerance:g} %), broken line: the median; dotted: "
        f"{LINEAR_UNTIL:g}, up to which the paper finds this system linear.",
        "Three plots on one logarithmic scale. The difference grows with the force and is the smaller the farther "
        "apart the loads are.",
        {
            **given,
            "force": parameters.forces,
            "distance": [2.0 * d for d in diameters],
            "realizations": parameters.pair_realizations,
        },
    )
    return found
