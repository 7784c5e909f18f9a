"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import WEIGHT, Caption, of_scene, panels, values

from . import draw
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    response = datasets["response"]
    frictions = response["friction"].values.tolist()
    stops = "".join(
        f" The curve of µ = {end.friction:g} ends at {end.force:g} {WEIGHT} to save time; the slab bears more."
        for end in parameters.ends
    )
    found = {
        "fig06_linear_range": Caption(
            "Response at x = 0 of ordered slabs per force, against the force, for several coefficients of friction. "
            "It is level in the linear range, which friction extends. Dotted: the forces at which the paper sees the "
            f"first contact open, without friction, at µ = 0.2 and at µ = 1.{stops}",
            "Curves against the force on a logarithmic axis, level and equal for small forces; they leave the level "
            "the later the larger the friction, most of them downwards, that of µ = 1 upwards.",
            of_scene(parameters.scene, force=response["force"].values.tolist(), friction=frictions),
        ),
        "fig07_friction_response": Caption(
            f"Floor response of ordered slabs per force, for growing forces. (a) µ = 0.2; the paper sees the crossover "
            f"from one peak to two near {draw.PAPER_CROSSOVER:g} {WEIGHT}. (b) µ = 1, the tops enlarged in the corner. "
            "Each curve has its symbols at other disks, as some nearly cover each other.",
            "Two plots on one scale. (a) A bell, a plateau and two peaks. (b) Bells that nearly cover each other.",
            of_scene(
                parameters.scene,
                force=draw.at_forces(response.sel(friction=0.2), draw.PROFILE_FORCES)["force"].values.tolist(),
                friction=[0.2, 1.0],
            ),
        ),
        "fig12_friction_crossover": Caption(
            "Floor response of ordered slabs at one force, for several coefficients of friction: two peaks at small "
            "ones, one at large ones.",
            "Curves from two high peaks without friction over a plateau to one peak.",
            of_scene(
                parameters.scene,
                force=parameters.friction_axis.force,
                friction=draw.at_frictions(datasets["friction_axis"], draw.AXIS_FRICTIONS),
            ),
        ),
    }
    for friction, stem in ((0.2, "fig08_contacts_mu02"), (1.0, "fig09_contacts_mu1")):
        states = datasets.get(f"states_mu_{friction:g}")
        if states is not None:
            shown = draw.contact_forces(states)
            found[stem] = Caption(
                f"What the force does to the contacts of an ordered slab at µ = {friction:g}, the central third: "
                "those that it opens (thick), that slide (middle) and that it leaves alone (thin). Arrow and circle: "
                f"the force and its disk; the line below is the floor. {panels(shown)}",
                f"Triangular networks at friction {friction:g}: open contacts below the force, sliding ones beside "
                "them, more and deeper from panel to panel.",
                of_scene(parameters.scene, force=shown, friction=friction),
            )
    if "large_forces" in datasets:
        dynamic = datasets["large_forces"]
        beyond = draw.at_forces(dynamic, draw.DYNAMIC_FORCES)["force"].values
        left = draw.at_forces(response.sel(friction=0.2), draw.LARGE_FORCES)["force"].values
        found["fig16_large_forces"] = Caption(
            f"Floor response of ordered slabs under large forces. (a) µ = 0.2, F_ext = {values(left.tolist())} "
            f"{WEIGHT}; the paper sees the crossover near {draw.PAPER_CROSSOVER:g} {WEIGHT} and a third peak at x = 0 "
            f"from {draw.PAPER_THIRD_PEAK:g} {WEIGHT} on. (b) µ = 1, dynamics from rest to F_ext = "
            f"{values(beyond.tolist())} {WEIGHT}; in the paper symmetry is lost beyond {draw.PAPER_SYMMETRIC:g} "
            f"{WEIGHT}, and at 95 {WEIGHT} the response is the mirror image of another.",
            "(a) A plateau, then two peaks with a third one between them. (b) One symmetric bell and three lopsided "
            "curves with a sharp negative dip to the left or the right of the middle.",
            of_scene(
                parameters.scene,
                force=sorted({*left.tolist(), *beyond.tolist()}),
                friction=[0.2, float(dynamic["friction"])],
            ),
        )
    return found
