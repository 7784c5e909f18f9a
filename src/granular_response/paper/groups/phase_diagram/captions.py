"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, Value

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    crossovers = datasets["crossovers"]
    here = crossovers["lattice_constant"].values == crossovers["lattice_constant"].values[0]
    frictions = sorted(set(crossovers["friction"].values[here].tolist()))
    deltas = sorted(set(crossovers["polydispersity"].values[here].tolist()))
    given: dict[str, Value] = {
        "friction": frictions,
        "wall_friction": frictions,
        "polydispersity": deltas,
        "realizations": int(crossovers["realizations"].values[here].max()),
        "width": parameters.widths,
    }
    last, rows = "abcdefghijklmnopqrstuvwxyz"[len(deltas) * len(parameters.widths) - 1], len(parameters.widths)
    last_of_few = "abcdefghijklmnopqrstuvwxyz"[(len(deltas) - 1) * rows - 1]
    return {
        "fig22_phase_diagram": Caption(
            f"(a) to ({last}) Crossover force from one peak to two against friction, measured on up to "
            f"{given['realizations']} slabs simulated like those of Fig. 21 and on the lattice: a column for each "
            "polydispersity, a row for each smoothing width. Full circles: crossovers of the mean response, at a dip "
            f"of {100 * parameters.tolerance:g} % of the largest response; open circles with an arrow: bounds, where "
            "the smallest force has two peaks already, or the largest one still. Thick and thin bars hold 68 and 95 % "
            f"of {parameters.draws} bootstrap draws over the realizations; an end beyond every simulated force has an "
            "arrow head at the edge. Dark: two peaks, light: one, white: not simulated, or too few packings bear the "
            "force. Broken line: the lattice, whose last point is a bound; crosses: where it loses its symmetry; "
            "star: where the paper's does beside smooth walls (Fig. 16).",
            "Eight diagrams of force against friction. The boundary between one peak below and two above rises with "
            "friction and lies lower the larger the polydispersity.",
            given,
        ),
        "five_realizations": Caption(
            f"Not in the paper, which averages {parameters.few} realizations: (a) to ({last_of_few}) part of the "
            f"means of {parameters.few} of all realizations, {parameters.draws} times drawn at random, that have as "
            "many peaks as the mean of all, against the force per crossover force of Fig. 22 (vertical line), for "
            "each polydispersity, smoothing width and coefficient of friction.",
            "Six panels with curves near 1 far from the crossover force, which dip to between 0.3 and 0.7 at it.",
            {**given, "friction": [mu for mu in frictions if mu], "wall_friction": [mu for mu in frictions if mu]}
            | {"polydispersity": [delta for delta in deltas if delta]},
        ),
        "peak_definitions": Caption(
            f"Not in the paper: (a) to ({last_of_few}) crossover force against friction by the dip at x = 0, per "
            "largest response, from which on a mean response counts as having two peaks, and the median crossover of "
            "single realizations; for each polydispersity and smoothing width. Bounds are left out.",
            "Six panels in which the force grows with friction, on curves that lie above each other in the order of "
            "the dip.",
            given | {"polydispersity": [delta for delta in deltas if delta]},
        ),
        "starts": Caption(
            "Not in the paper: (a) to (c) dip of the mean response under one force, smoothed with the smaller width, "
            "and (d) to (f) contacts per disk at rest, against the lattice constant of the start. Bars hold 95 % of "
            "the bootstrap draws over the realizations; broken lines: the largest disks touch.",
            "Six panels: dips without friction grow with the lattice constant, contacts become fewer.",
            {"friction": [0.0, 0.2], "polydispersity": [delta for delta in deltas if delta]},
        ),
    }
