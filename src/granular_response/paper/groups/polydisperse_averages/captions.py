"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    scene = parameters.scene
    picture, single, linear = parameters.forces_picture, parameters.individual, parameters.linear_range
    return {
        "fig02_polydisperse_forces": Caption(
            "Contact forces in a disordered packing: (a) under gravity, (b) what a force on top adds. Marks on the "
            "disks show how far they have turned. Line widths and lengths are proportional to the force.",
            "Two pictures of a packing with its contact forces as lines.",
            of_scene(
                scene,
                force=picture.force,
                friction=picture.friction,
                wall_friction=picture.friction,
                polydispersity=picture.polydispersity,
            ),
        ),
        "fig19_disordered_response": Caption(
            "Slightly disordered slabs without and with friction: single realizations thin, their mean thick. Above, "
            "(a), (b), the largest disks touch at the start, which gives the paper's peaks; below, (c), (d), the start "
            "is the lattice that its text names, of constant two mean radii.",
            "Four panels with many thin curves and a thick one: two peaks without friction, one with it.",
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
            "(a), (b) Response at x = 0 per applied force in one slightly disordered slab, for several coefficients of "
            "friction, beside the lattice, and (c) where their linear ranges end (arrows: beyond the largest force).",
            "Curves against the force, level at first; then the ends of their level parts against friction.",
            of_scene(
                scene,
                force=linear.forces,
                friction=linear.frictions,
                wall_friction=0.0,
                polydispersity=linear.polydispersities,
                width=linear.width,
            ),
        ),
        "fig21_disordered_forces": Caption(
            "Mean floor response of disordered slabs, with its standard error, for several polydispersities, "
            "coefficients of friction and forces. A number in brackets is that of the slabs at rest, where some "
            "collapsed.",
            "A table of panels with curves of one or two peaks.",
            of_scene(scene, friction=None, wall_friction=None, realizations=parameters.realizations),
        ),
        "packings": Caption(
            "Packings at rest: (a) directions of their contacts without friction for both starts, (b) contacts of a "
            "disk away from the boundaries (bars: standard deviation), and (c) the part that does not collapse under a "
            "force (colours as before).",
            "Three plots: contact directions, contacts per disk, packings that stay at rest.",
        ),
    }
