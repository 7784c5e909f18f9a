"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "fig22_phase_diagram": Caption(
            "Crossover force from one peak to two against friction, for each polydispersity and two smoothing widths "
            "(broken line: the lattice, its last point a bound). Thick and thin bars hold 68 % and 95 % of the "
            "bootstrap draws over realizations, with an arrow head where an end lies beyond every simulated force; "
            "open circles with an arrow are bounds of the crossover itself. Dark: two peaks, light: one, white: not "
            "simulated.",
            "Crossover forces that grow with friction and fall with polydispersity.",
            {"width": parameters.widths},
        ),
        "five_realizations": Caption(
            f"How often the mean response of {parameters.few} slabs has as many peaks as that of all, against the "
            "force over the crossover force, for each polydispersity, smoothing width and coefficient of friction.",
            "Curves that dip near the crossover force.",
            {"width": parameters.widths},
        ),
    }
