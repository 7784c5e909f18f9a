"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import RADIUS, WEIGHT, Caption, of_scene

from .draw import FIG21_WIDTH, KEYS, PAPER_CONTACTS
from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    scene = parameters.scene
    picture, single, linear = parameters.forces_picture, parameters.individual, parameters.linear_range
    disordered = sorted({case.polydispersity for case in parameters.columns if case.polydispersity})
    frictions = sorted({case.friction for case in parameters.columns})
    forces = sorted({force for case in parameters.columns for force in case.forces})
    last = "abcdefghijklmnopqrstuvwxyz"[len(disordered) * len(frictions) - 1]
    at_rest, added = KEYS
    ensemble = of_scene(
        scene,
        friction=frictions,
        wall_friction=frictions,
        polydispersity=disordered,
        realizations=parameters.realizations,
    )
    return {
        "fig02_polydisperse_forces": Caption(
            "Contact forces in a disordered packing: (a) at rest under gravity, (b) what a vertical force on top "
            "adds, the forces of (a) subtracted as vectors. Lengths and widths of the lines are proportional to the "
            f"force, but none is thinner than a hairline; the line of the key stands for {at_rest:g} {WEIGHT} in (a) "
            f"and for {added:g} {WEIGHT} in (b). Marks on the disks were vertical in the lattice of the start: they "
            "show how far the disks have turned. Circle and arrow: the loaded disk and the force. Floor and walls "
            "are grey.",
            "Two pictures of a packing with its contact forces as lines. Gravity makes branching chains that thicken "
            "towards the floor; the load adds a few chains that spread below it.",
            of_scene(
                scene,
                force=picture.force,
                friction=picture.friction,
                wall_friction=picture.friction,
                polydispersity=picture.polydispersity,
            ),
        ),
        "fig19_disordered_response": Caption(
            "Smoothed floor response of slightly disordered slabs, (a), (c) without and (b), (d) with friction: "
            "single realizations thin, their mean thick, in a band of its standard error. In (a), (b) the largest "
            "disks touch at the start, which gives the paper's peaks; in (c), (d) the start is the lattice that its "
            "text names. Their numbers of realizations stand over the panels.",
            "Four panels on one scale. Without friction thin curves scatter widely about a mean with two peaks if the "
            "largest disks touch at the start, and with one peak otherwise; with friction they scatter little.",
            of_scene(
                scene,
                force=single.force,
                friction=single.frictions,
                wall_friction=single.frictions,
                polydispersity=single.polydispersity,
                realizations=single.realizations,
                width=single.width,
            ),
        ),
        "fig20_disordered_linear_range": Caption(
            "Smoothed floor response at x = 0 per force, against the force, for several coefficients of friction: "
            "(a) of one disordered slab with smooth walls, as in the paper, (b) mean of the realizations of Fig. 21, "
            "whose walls have the friction of the disks, with standard errors, (c) of the lattice with smooth walls. "
            "(d) Where the linear ranges of (a) and (c) end: between the last force at which the response has "
            f"changed by at most {100.0 * float(datasets['linear_range'].attrs['tolerance']):g} % and the next. Of "
            "one slab they say little: (b) shows how far packings differ.",
            "Three plots of level curves that fall beyond some force, the later the larger the friction. Without "
            "friction the one slab lies far above the mean.",
            of_scene(
                scene,
                force=linear.forces,
                friction=linear.frictions,
                wall_friction=0.0,
                polydispersity=linear.polydispersities,
                realizations=parameters.realizations,
                width=linear.width,
            ),
        ),
        "fig21_disordered_forces": Caption(
            f"(a) to ({last}) Mean smoothed floor response of disordered slabs with bands of one standard error, all "
            "on one scale, for several polydispersities, coefficients of friction and forces. Over each panel its "
            f"forces in {WEIGHT}; a number in brackets is that of the slabs at rest, where some collapsed.",
            "A table of panels. Without friction two peaks at every force; with friction one peak at the smallest "
            "force, which becomes two as the force grows, at smaller forces the larger the polydispersity.",
            {**ensemble, "force": forces, "width": FIG21_WIDTH},
        ),
        "packings": Caption(
            "Not in the paper: the packings at rest. (a) Directions of their contacts without friction, for every "
            f"polydispersity, and at the smallest for the start with lattice constant 2 {RADIUS} (full line). (b) "
            "Contacts of a disk away from the boundaries, with standard deviations over the realizations, mostly "
            f"smaller than the symbols; dotted: {PAPER_CONTACTS:g}, the paper's at the smallest polydispersity "
            "without friction. (c) Part of the packings that does not collapse under a force, with its binomial "
            "standard error; cases in which all stay at rest are not drawn.",
            "Three plots: contact directions with peaks at 0, 60 and 120 degrees, which widen with polydispersity; "
            "contacts per disk, which fall with friction; parts at rest, which fall beyond some force.",
            ensemble,
        ),
    }
