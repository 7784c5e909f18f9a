"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, WEIGHT, Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    counts = {case.count(h) for case in parameters.cases if case.polydispersity for h in range(len(case.heights))}
    disorder = (
        f"Disorder: of the mean profile of {' or '.join(map(str, sorted(counts)))} realizations. " if counts else ""
    )
    low, high = parameters.fitted
    said = of_scene(
        parameters.base, friction=None, wall_friction=None, polydispersity=None, packing=None, normal_stiffness=None,
        width=parameters.width,
    )  # fmt: skip
    reference = parameters.reference_layers
    surveyed = [layers for case in parameters.cases for layers in case.surveyed]
    stored = f"packings of the survey, {min(surveyed)} to {max(surveyed)} layers" if surveyed else ""
    edges, along = (f"Black edges: {stored}. ", f"With {stored}. ") if stored else ("", "")
    slabs = (
        f"Walls and floor have the friction of the disks; rows have {parameters.disks_per_layer} disks for each layer; "
        f"k_N = {parameters.base.contact.normal_stiffness:g} {WEIGHT}/{RADIUS} at {reference} layers grows as their "
        f"number. Forces F, in {WEIGHT}, are those at {reference} layers and grow as the square of the number; "
        "without one the limit of small forces. * gravity acts on disks without friction, which rub from then on."
    )
    return {
        "peak_width_depth": Caption(
            "Not in the paper: how wide the response is. Filled symbols: half width at half maximum of the vertical "
            "stress; open symbols: half width of the strip that bears half of the force; crosses: place of one of two "
            "peaks, where there are two. (a) to (c) on lines inside the highest slab, (d) to (f) on the floors of "
            f"slabs of several heights. {edges}Grey lines: elastic slabs of the lattice's "
            "moduli, for the first case of a panel. Black lines have the slopes 1 (elastic) and 1/2 (diffusion). "
            f"{disorder}{slabs}",
            "Six panels with double logarithmic axes: symbols along lines of slope 1 for lattices under small forces "
            "and for disorder with friction.",
            said,
        ),
        "peak_width_powers": Caption(
            "The powers with which these widths grow: (a) inside the highest slabs, from a depth of "
            f"{low:g} {RADIUS} to {high:g} heights, (b) on the floors. 95 % intervals of the bootstrap over "
            "realizations; of a lattice the range over fits without the shallowest and without the deepest third. "
            f"{along}"
            "Ticks: elastic slabs of the same heights by the same code. Dashed 1, dotted 1/2; in the grey band a "
            f"power is nearer to 1 than to 1/2. {slabs}",
            "Two panels of points with error bars in a row for each packing, most of them in a band around 1.",
            said,
        ),
    }
