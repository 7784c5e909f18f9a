"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, WEIGHT, Caption, of_scene, panels, values

from .draw import COMPARED_FORCE, NETWORK_FORCES, PROFILE_FORCES, STIFFNESS_FORCES, nearest
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""

    def drawn(wanted: tuple[float, ...], dataset: str) -> list[float]:
        stored = datasets[dataset]["force"].values
        return stored[nearest(stored, wanted)].tolist()

    slab = of_scene(parameters.scene)
    depths, stiffnesses = values([n for n, _ in parameters.sizes]), values(parameters.size_stiffnesses)
    deep = {**slab, "normal_stiffness": parameters.size_stiffnesses, "packing": f"slabs of {depths} layers"}
    compared = values(drawn((COMPARED_FORCE,), "sizes"))
    return {
        "fig03_frictionless_response": Caption(
            "Ordered slab without friction under a growing force. (a) Floor response per force in the interior of the "
            "slab: one peak splits into two. (b) Response at x = 0 and its largest value against the force; broken "
            "lines: forces at which the first contact opens, two peaks appear and the region of open contacts reaches "
            "the floor; dotted: first opening in the paper.",
            "(a) Curves from a single bell at small forces to two sharp peaks at large ones. (b) Both measures agree "
            "until there are two peaks, then the response at x = 0 falls and the largest grows.",
            {**slab, "force": drawn(PROFILE_FORCES, "response")},
        ),
        "fig04_frictionless_contacts": Caption(
            "Contacts that the force opens in the slab of Fig. 3 (thick), and those that it does not (thin), the "
            "central third. Arrow and circle: the force and its disk; the line below is the floor. "
            + panels(drawn(NETWORK_FORCES, "states")),
            "Triangular networks in which horizontal contacts open in a teardrop below the force, which grows until it "
            "stands on the floor as a triangle.",
            {**slab, "force": drawn(NETWORK_FORCES, "states")},
        ),
        "fig05_teardrop": Caption(
            "Depth (left) and largest width (right) of the region of open contacts below the force, for slabs of "
            f"several depths at k_N = {stiffnesses} {WEIGHT}/{RADIUS}, (a), (b) above and (c), (d) below. A curve "
            "ends where the region reaches the floor (open symbol). In 60 layers of the paper's stiffness gravity "
            "compresses the slab so far that its horizontal contacts carry far more than those of stiff slabs: "
            "the first one opens late and the region stays small, which is not the effect of size that the paper "
            "shows. Of stiff disks 60 layers are like the others.",
            "Curves that grow with the force, deeper slabs a little later; with soft disks that of 60 layers stays "
            "low.",
            deep,
        ),
        "fig05b_stiffness": Caption(
            "What the stiffness of the disks changes in the slab of Fig. 3. (e) Response at x = 0 over that of the "
            "stiffest disks; shaded: 2 % from 1000 to 1e5, as the paper says. (f) Depth and largest width of the "
            "region of open contacts; dotted: 2000, from which the paper sees it saturate. (g) Forces at which the "
            "first contact opens, two peaks appear and the region reaches the floor. Stiffnesses at which gravity "
            "alone rearranges the lattice are left out.",
            "Three plots against the stiffness on a logarithmic axis; all curves level off beyond 2000.",
            {**slab, "force": drawn(STIFFNESS_FORCES, "stiffness"), "normal_stiffness": parameters.stiffnesses},
        ),
        "fig05c_depth_and_width": Caption(
            f"(h) Depth of the region for slabs of several widths; open symbols as in (a). (i) Response at {compared} "
            f"{WEIGHT} for several depths, over the height h. (j) Forces at which two peaks appear and the region "
            "reaches the floor, against the depth.",
            "Three plots: depth against force, responses with two peaks in shallow slabs and one in deep ones, and "
            "forces of the events that grow with the depth.",
            {**deep, "force": parameters.size_forces},
        ),
    }
