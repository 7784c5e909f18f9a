"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    most = max(case.realizations for case in parameters.cases)
    maps = [case for case in parameters.cases if case.polydispersity == parameters.cases[-1].polydispersity]
    panels = ", ".join(
        f"({chr(ord('a') + k)}) δ = {case.polydispersity:g}, µ = {case.friction:g}" for k, case in enumerate(maps)
    )
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None)
    low, high = parameters.fitted
    return {
        "influence_map": Caption(
            "Not in the paper: how much force every disk sets in motion on the floor. A small vertical force on a disk "
            "changes the forces on the floor; the colour is the sum of their absolute changes per force, 1 where no "
            "floor disk is relieved. Exact in the limit of small forces, at rest under gravity, contacts at the limit "
            "of Coulomb sticking; the walls have the friction of the disks. Disks that bear nothing are white. "
            f"{panels}.",
            "The same slab with and without friction, its disks coloured by the force that each sets in motion: all "
            "alike with friction, in bright wedges without.",
            said,
        ),
        "influence_saint_venant": Caption(
            "Saint-Venant's principle, by which Sec. VI explains that superposition holds. (a) Changes of the floor "
            "forces by a small force on a disk, and by two halves of it on its neighbours in the row: their absolute "
            "difference summed over the floor disks, against the height of the disk over the distance of the halves; "
            f"mean and standard deviation over {most} realizations. (b) The power with which it falls between {low:g} "
            f"and {high:g} distances, with 95 % intervals of the mean; of a lattice the range over the rows fitted.",
            "Falling lines in a double logarithmic panel, steepest for the lattices, flat for disorder without "
            "friction; beside it the powers as symbols with error bars, two for the frictionless lattice.",
            said,
        ),
    }
