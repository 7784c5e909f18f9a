"""Elastic moduli of packings and of loaded slabs from their own stiffness, and the response of elastic slabs with them.

``packings``: a packing in the initial equilibrium is strained as a whole (``solvers.strain``). Disks follow the strain
(affine), or relax with rotations suppressed or free. The last moduli are those of the packing. The elastic slab of the
same height and width with them (``theory.slab``) has a response to a small force on its top with nothing to fit. The
packing's own response to small forces on each disk of the top row is exact in the limit (``solvers.small_loads``);
periodic sides make all of them comparable. Both are compared for single loads, and for the mean over the loads of a
packing.

``slabs``: incremental moduli of lattices under a growing force, place by place (:mod:`.loaded`).
"""

from __future__ import annotations

from functools import partial

import xarray as xr

from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response_extensions.moduli.parameters import Parameters
from granular_response_extensions.moduli.simulate.loaded import loaded_slabs
from granular_response_extensions.moduli.simulate.response import PLACES, SOLIDS, PackingModuli, compute
from granular_response_extensions.surveyed import measured
from granular_response_paper.datasets import labelled
from granular_response_paper.parameters import SIZE, material
from granular_response_paper.records import axes, column, labels, record, stacked, table, variables

FRICTION = "friction between disks and of the floor"


@record
class PackingKey:
    """What tells a packing from others."""

    polydispersity: float = column("polydispersity")
    friction: float = column(FRICTION)
    layers: int = column("number of rows")
    realization: int = column("realization of the disorder")


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``packings`` and ``slabs``."""
    packed = labelled({"packings": _packings(parameters)}, parameters.base)
    return packed | labelled({"slabs": loaded_slabs(parameters)}, parameters.lattice)


def packings(parameters: Parameters, *, surveyed: bool) -> dict[tuple[int, int, int], PackingKey]:
    """The packings of the survey, or all others, by their places: of the case, of its size, and the realization."""
    return {
        (c, s, r): PackingKey(case.polydispersity, case.friction, case.layers[s], r)
        for c, case in enumerate(parameters.cases)
        for s, (own, further) in enumerate(zip(case.realizations, case.further, strict=True))
        for r in (range(own, own + further) if surveyed else range(own))
    }


def task(parameters: Parameters, one: PackingKey) -> partial[PackingModuli]:
    """One of these packings."""
    p, (layers, disks_per_row) = parameters, SIZE
    size = {layers: one.layers, disks_per_row: p.disks_per_layer * one.layers, "packing.sides": "periodic"}
    changes = material(one.polydispersity, one.realization, one.friction)
    scene = p.base.updated({**size, "packing.lattice_constant": TOUCHING_LARGEST, **changes})
    return partial(compute, scene, p.margin, p.width, p.wide)


def _packings(parameters: Parameters) -> xr.Dataset:
    cases = parameters.cases
    # the largest first: two workers then end together
    outcomes = measured(parameters, "packings", packings, task, PackingModuli, work=lambda p: cases[p[0]].layers[p[1]])
    found = table(outcomes, "case", "size", "realization")
    layers = stacked({(c,): case.layers for c, case in enumerate(cases)}, float)
    coordinates = axes(
        solid=(SOLIDS, "moduli of the elastic slab"),
        smoothing=([f"{parameters.width:g} radii", f"{parameters.wide:.3g} heights"], "w of the Gaussian"),
        place=(PLACES, "distance from the load over the height of the slab"),
    )
    named = labels("case", cases, polydispersity="polydispersity", friction=FRICTION)
    return found.assign(variables(layers=("case size", layers, "number of rows"))).assign_coords(named | coordinates)
