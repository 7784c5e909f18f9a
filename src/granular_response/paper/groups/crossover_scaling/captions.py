"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene, values

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    slabs = datasets["slabs"]
    layers = values(sorted(set(slabs["layers"].values.tolist())))
    frictions = sorted(set(slabs["friction"].values.tolist()))
    said = of_scene(parameters.base, friction=frictions, normal_stiffness=None, packing=None)
    stiffness = values(parameters.series[0].stiffness_per_layer)
    deep = {layers for one in parameters.series for layers in one.surveyed}
    survey = " Black edges: slabs of the survey, simulated apart from the pipeline." if deep else ""
    return {
        "crossover_scaling": Caption(
            "Not in the paper: what the number of layers N does. (a) Force from which the floor response has two "
            f"peaks, a dip at x = 0 of {parameters.visible:g} of its largest value; (b) force at which the region of "
            "open contacts reaches the floor; (c) force at which the first contact opens in the central third. Bars "
            "are brackets; lines and numbers powers of N, with the range over the fits with and without the smallest "
            "slab and over the brackets. P is the force of horizontal contacts at rest: constant, in proportion to N "
            "as the weight, or what the paper's walls make it. Periodic sides but where walls are named; "
            f"{layers} layers; k_N = {stiffness} N, so that gravity makes the same overlaps in all.{survey}",
            "Double logarithmic panels. Two peaks come along straight lines, about twice as steep with friction as "
            "without; the region's lines are as steep where P grows with N; the first opening rises least.",
            said,
        ),
        "crossover_scaling_regions": Caption(
            "Depth of the region of open contacts below the load over that of the slab, against the force over what it "
            "is scaled by: (a) without friction layers times the force P of horizontal contacts at rest, (b) and (c) "
            "with friction layers squared.",
            "Curves of slabs of different depths that fall on one another where the force is scaled.",
            said,
        ),
        "crossover_scaling_apart": Caption(
            "What else sets the force from which there are two peaks, each varied alone: (a) width, (b) stiffness at "
            "the same P, (c) force P of horizontal contacts at rest. Numbers are powers with ranges, as for layers; "
            "with friction the force levels off where P is small.",
            "Nearly level lines for width and stiffness; against the confinement a straight rise without friction "
            "and hardly any with friction.",
            said,
        ),
    }
