"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .draw import looped
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    curves = datasets["curves"]
    cases, one = looped(curves["polydispersity"].values, curves["friction"].values)
    lattices = [parameters.cases[case] for case in cases]
    most = max(case.realizations + case.surveyed for case in parameters.cases)
    further = max(case.surveyed for case in parameters.cases)
    survey = f", {further} of which the survey has simulated" if further else ""
    part = f"{100.0 * parameters.left:g} %"
    said = of_scene(parameters.base, friction=None, polydispersity=None)
    return {
        "hysteresis_loops": Caption(
            "Not in the paper: a force on the top disk grows, falls to nothing and grows again, along paths of "
            "equilibria. (a) Force against the displacement of the loaded disk in lattices; without friction all three "
            "ways are one curve. (b) What is added to the floor forces under the lattice with "
            f"µ = {parameters.cases[one].friction:g}: by the force, after it, and by it again.",
            "Force against displacement: one line without friction, narrow loops with friction. Beside it floor forces "
            "against position: loaded and loaded again lie on each other, and unloading leaves a small remainder.",
            said | {"friction": [case.friction for case in lattices], "force": lattices[0].forces[-1]},
        ),
        "hysteresis_ranges": Caption(
            "Not in the paper: what is irreversible. (a) Largest change of a floor force that a loop to F_ext and back "
            f"leaves, per largest change under F_ext; dashed: {part}. (b) Energy that goes into sliding, and where "
            "dynamics crosses the end of a branch, in that first loop and in the second one, per work of the first "
            "loading. Means over realizations of packings with friction; what is less than the axis shows is drawn on "
            "its end. (c) Forces up to which no contact near the load opens, the response at x = 0 is linear within "
            f"1 %, and a loop leaves less than {part} on the floor: medians and extremes over up to {most} "
            f"realizations{survey}. Open symbols with arrows: beyond the largest force in some of them.",
            "Two double logarithmic panels with rising curves, and a panel with a row for each packing in which three "
            "symbols mark forces: without friction the reversible range mostly has no end.",
            said | {"friction": sorted({case.friction for case in parameters.cases})},
        ),
    }
