"""Elastic moduli of packings from their own stiffness, and the response of the elastic slab that they predict.

A packing at rest is strained as a whole (``solvers.strain``): disks follow the strain (affine), or relax with rotations
suppressed or free. The last moduli are those of the packing, and the elastic slab (``theory.slab``) of the same height
and width with them has a response to a small force on its top with nothing to fit. The packing's own response to small
forces on each disk of the top row is exact in the limit (``solvers.small_loads``); periodic sides make all of them
comparable. ``packings`` has both and what they differ by: for single loads, and for the mean over the loads of a
packing. ``lattice`` has the moduli of lattices beside the closed form, and where the response turns from one peak to
two by the closed form's moduli, by measured ones, and in lattices themselves.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.solvers.strain import FOLLOWING
from granular_response_extensions.moduli.parameters import Parameters
from granular_response_extensions.moduli.simulate.lattices import lattice_study, slab_scene
from granular_response_extensions.moduli.simulate.response import PLACES, SOLIDS, Outcome, compute, symmetric
from granular_response_extensions.moduli.simulate.sizes import needed
from granular_response_extensions.surveyed import measured
from granular_response_paper.datasets import labelled
from granular_response_paper.parameters import material
from granular_response_paper.records import axes, column, labels, record, stacked, table, variables

FRICTION = "friction between disks and of the floor"


@record
class Disordered:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column(FRICTION)
    layers: int = column("number of rows")
    realization: int = column("realization of the disorder")


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``packings`` and ``lattice``."""
    return labelled({"packings": _packings(parameters), "lattice": lattice_study(parameters)}, parameters.base)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int, int], Disordered]:
    """The packings of the survey, or all others, by their places: of the case, of its size, and the realization."""
    return {
        (c, s, r): Disordered(case.polydispersity, case.friction, case.layers[s], r)
        for c, case in enumerate(parameters.cases)
        for s, (own, further) in enumerate(zip(case.realizations, case.further, strict=True))
        for r in (range(own, own + further) if surveyed else range(own))
    }


def task(parameters: Parameters, one: Disordered) -> partial[Outcome]:
    """One of these packings."""
    p, changes = parameters, material(one.polydispersity, one.realization, one.friction)
    scene = slab_scene(p, one.layers, p.disks_per_layer * one.layers, TOUCHING_LARGEST, changes)
    return partial(compute, scene, p.margin, p.width, p.wide)


def _packings(parameters: Parameters) -> xr.Dataset:
    cases = parameters.cases
    # the largest first: two workers then end together
    outcomes = measured(parameters, "packings", packings, task, Outcome, work=lambda at: cases[at[0]].layers[at[1]])
    found = table(outcomes, "case", "size", "realization").rename(matrices="stiffness")
    layers = stacked({(c,): case.layers for c, case in enumerate(cases)}, float)
    surveyed = np.nan_to_num(stacked({(c,): case.further for c, case in enumerate(cases)}, float))
    loads = {"one": found["single"].values, "mean": found["difference"].values[:, :, :, SOLIDS.index("free")]}
    differences = np.moveaxis(np.stack(list(loads.values())), (1, 0, 4), (0, 1, 2))
    tolerances = np.array(parameters.tolerances)
    sizes_needed = {
        at: needed(layers[at[0]], differences[at], tolerances, parameters.draws, parameters.seed)
        for at in np.ndindex(differences.shape[:3])
    }
    matrices = found["stiffness"].values
    prestress = symmetric(matrices[..., -1, :, :] - found["springs_alone"].values)
    mirrored = "moduli over k_N, what a solid that mirrors itself has of them"
    added = "what the forces that contacts bear at rest add to the moduli over k_N, rotations free"
    below = "number of rows from which on the difference is below the tolerance, by a power of it"
    derived = variables(
        layers=("case size", layers, "number of rows"),
        surveyed=("case size", surveyed, "realizations that are the survey's"),
        moduli=("case size realization following modulus", symmetric(matrices), mirrored),
        prestress=("case size realization modulus", prestress, added),
        needed=("case loads smoothing tolerance end", stacked(sizes_needed), below),
    )
    components = ["xx", "zz", "xz"]
    coordinates = axes(
        following=(FOLLOWING, "how displacements and rotations follow the strain"),
        solid=(SOLIDS, "moduli of the elastic slab"),
        modulus=("abcd", "modulus of eq. (6)"),
        stress=(components, "component of the stress"),
        strain=(components, "component of the strain"),
        smoothing=([f"{parameters.width:g} radii", f"{parameters.wide:.3g} heights"], "w of the Gaussian"),
        loads=(loads, "one load, or the mean over the loads of a packing"),
        tolerance=(tolerances, "difference to the elastic slab"),
        end=(["value", "low", "high"], "value, and the 95 % interval of the bootstrap"),
        place=(PLACES, "distance from the load over the height of the slab"),
    )
    named = labels("case", cases, polydispersity="polydispersity", friction=FRICTION)
    return found.drop_vars("springs_alone").assign(derived).assign_coords(named | coordinates)
