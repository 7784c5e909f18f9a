"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    shared = of_scene(parameters.scene)
    both = (
        "The response to two loads and the sum of the responses to each, disk by disk, for several distances d."
    )
    seen = "Panels with curves of two loads and of their sum, which cover each other."
    return {
        "fig23_superposition": Caption(both, seen, {**shared, "force": 0.2}),
        "fig24_superposition": Caption(both, seen, {**shared, "force": 1.0}),
        "fig24b_superposition_error": Caption(
            "Difference of the two, root mean square relative to both, against the force for (e) the floor and (f) all "
            "contacts, and (g) against depth. Means of the realizations with standard errors. Dotted: change of the "
            "contact forces per force under a single load, relative to the smallest. Shaded: where the linear range of "
            "the middle half of the realizations ends; broken line: its median.",
            "Three plots of the difference, which grows with the force and falls with the depth.",
            {**shared, "realizations": parameters.pair_realizations},
        ),
    }
