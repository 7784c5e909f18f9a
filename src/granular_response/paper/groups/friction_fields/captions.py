"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, Caption, of_scene, values

from .draw import LEVELS
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    frictions = list(parameters.frictions)
    given = of_scene(parameters.scene, force=parameters.force, friction=frictions, wall_friction=frictions)
    each = [f"µ = µ_wall = {mu:g}" for mu in frictions]
    below = sorted(float(depth) for depth in datasets["profiles"]["depth"].values) if "profiles" in datasets else []
    profiles = list(parameters.profiles.frictions)
    return {
        "fig13_force_chains": Caption(
            f"Contact forces that the force adds in ordered slabs, the central third: {lettered(each)}. The effect of "
            "gravity is subtracted as a vector. Lengths and widths of the lines are proportional to the force, the "
            "same in all panels, but none is thinner than a hairline. Arrow and circle: the force and its disk; the "
            "line below is the floor.",
            "Two force chains along the lattice without friction, chains in many directions with it and a vertical "
            "one at the largest friction.",
            given,
        ),
        "fig14_vertical_stress": Caption(
            "Vertical stress of the forces of Fig. 13, coarse-grained with a Gaussian: "
            f"{lettered([*each, 'the isotropic '])}harmonic lattice, with contours at {values(LEVELS)} of the largest "
            "stress. (e) to (g) Differences of (a) to (c) to (d), contours broken where it is negative. The colours "
            "of all maps are in equal steps of the square root. Hatched: the layer of one width w at the floor, in "
            "which part of the Gaussian lies outside the slab, so that the stress falls short.",
            "Maps of the stress: two lobes without friction, one broad lobe at the largest friction, nearly that of "
            "the isotropic lattice.",
            {**given, "width": parameters.stress_width},
        ),
        "fig15_force_profiles": Caption(
            "Magnitudes of the contact forces between rows that a large force adds, against the horizontal position, "
            f"at depths of {values([round(depth, 1) for depth in below])} {RADIUS} below the force: "
            f"{lettered([f'µ = µ_wall = {mu:g}' for mu in profiles])}. Both panels have one scale, of the square root.",
            "Curves with two sharp peaks without friction, and with a peak in the middle with it.",
            of_scene(parameters.scene, force=parameters.profiles.force, friction=profiles, wall_friction=profiles),
        ),
    }


def lettered(panels: list[str]) -> str:
    """What each panel shows."""
    return ", ".join(f"({chr(ord('a') + k)}) {text}" for k, text in enumerate(panels))
