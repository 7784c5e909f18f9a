"""Two forces at once against the sum of each alone: Figs. 23 and 24 (Sec. VI.B), claims U1 to U3.

Equal vertical forces act on two disks of the top row, as many places to the left as to the right of the middle
one: on the left one alone, on the right one alone, on both. All three start from the same rest state, and every load
grows from zero. The superposition error is the size of ``both - left - right`` relative to that of ``both``: over
the added forces on the floor, over the added forces at all contacts as vectors, and over those between neighbouring
rows, which tells how it changes with depth. A single load on the middle disk, on a path of its own, tells where the
response of the slab ceases to be linear.

The paper shows one realization; here are several, and where the motion of the disks had a part in a path is stored.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_of
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.superposition.parameters import Parameters
from granular_response_paper.groups.superposition.simulate.loads import PARTS, load_pair, load_single
from granular_response_paper.records import axes, places, table, variables
from granular_response_paper.tasks import computed


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``responses``, ``errors`` and ``linear_range``.

    SweepError
        If a realization does not come to rest, at rest or under a load: none is left out in silence.
    """
    asked, offsets, drawn = parameters, parameters.offsets, range(parameters.realizations)
    scenes = {r: asked.base.updated({"packing.realization": r}) for r in drawn}
    rests = computed({r: partial(rest_of, scene) for r, scene in scenes.items()}, "rest")
    singles = computed({r: partial(load_single, scene, rests[r], asked) for r, scene in scenes.items()}, "single loads")
    two = places(drawn, offsets)
    both = {at: partial(load_pair, scenes[r], rests[r], offset, asked.forces) for at, (r, offset) in two}
    pairs = computed(both, "pairs of loads")

    packing, middle = asked.base.packing.build(), f"from the middle disk on top {RADII}"
    load_x = [[pairs[r, k].load_x - singles[r].load_x for k in range(len(offsets))] for r in drawn]
    where = variables(
        x=("realization floor_disk", [singles[r].x for r in drawn], f"rest position of a floor disk {middle}"),
        load_x=("realization distance side", load_x, f"rest position of the loaded disks {middle}"),
    )
    apart = "places between the two loaded disks, their distance in mean disk diameters"
    coordinates = axes(
        distance=(2.0 * np.array(offsets), apart), force=(asked.forces, f"each of the two applied forces {WEIGHTS}")
    )
    further = axes(
        floor_disk=(np.flatnonzero(packing.row == 0), "index of the floor disk"),
        part=(PARTS, "which of the forces act"),
        side=(PARTS[:2], "which of the loaded disks"),
    )
    gaps = np.sqrt(3.0) * (np.arange(int(packing.row.max())) + 0.5)
    depth = axes(gap=(gaps, f"depth below the top row, on the lattice {RADII}"))
    found, responses = table(pairs, "realization", "distance"), ["floor_response", "by_motion"]
    linear = table(list(singles.values()), "realization").assign_coords(
        axes(force=(asked.single_forces, f"force on the middle disk {WEIGHTS}"))
    )
    datasets = {
        "responses": found[responses].assign(where).assign_coords(coordinates | further),
        "errors": found.drop_vars(responses).assign_coords(coordinates | depth),
        "linear_range": linear.assign_attrs(width=asked.width, tolerance=asked.tolerance),
    }
    return labelled(datasets, asked.base)
