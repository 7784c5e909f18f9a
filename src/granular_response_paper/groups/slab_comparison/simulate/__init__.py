"""The response to a small force beside that of an elastic slab, as the number of layers grows (Sec. II.A, Fig. 1a).

A lattice of equal bonds is isotropic in the long run, so the floor response of a packing that loses no contact must
approach the elastic solution of its own moduli and floor. ``slabs`` holds both for packings of growing depth and their
distance; the distance to the solution with the other kind of floor says how much a distance means.

What keeps a packing from it: contacts that are open at rest (beside smooth walls gravity opens some, in a part of the
slab that does not shrink with depth; a sudden fall on a rough floor can open a row in the middle), and contacts that
slide (gravity that grows slowly leaves some at the Coulomb limit).
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.scene import Scene
from granular_response.state import FloatArray, State
from granular_response.store.result import certificates_dataset
from granular_response.store.variables import RADII, variable
from granular_response.studies import LoadPath, Measures
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import Floor, response_of_layers
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.slab_comparison.parameters import DepthSeries, Parameters
from granular_response_paper.records import column, labels, record, table
from granular_response_paper.tasks import computed

FLOORS: tuple[Floor, ...] = ("smooth", "rough")

#: Floor disks within this many slab heights of the load are compared; the walls are farther off.
COMPARED = 1.5
_COMPARED = f"largest difference within {COMPARED:g} slab heights of the load, per largest elastic response"


@record
class Comparison:
    floor_response: FloatArray = column("floor response per force", "floor_disk")
    elastic: FloatArray = column("share of the elastic slab with the same moduli, floor and walls", "floor_disk")
    x: FloatArray = column(f"position from the loaded disk {RADII}", "floor_disk")
    distance: float = column(f"packing and elastic slab: {_COMPARED}")
    distance_other_floor: float = column(f"packing and elastic slab with the other floor: {_COMPARED}")


def compute(base: Scene, case: DepthSeries, layers: int, force: float) -> tuple[Comparison, State]:
    """The response to the force beside that of elastic slabs, and the state under the force.

    ``base`` has one load of unit force. Raises what the solvers raise.
    """
    path = LoadPath.of(_scene(case, layers, base))
    (_, full), measures = path.through([0.5 * force, force]), Measures(path)
    response, x = measures.response(full), measures.x
    ratio = base.contact.stiffness_ratio
    solid = lattice.moduli(Springs.uniform(1.0, ratio if case.friction > 0.0 else 0.0), "free")
    elastic = {
        floor: response_of_layers(x, layers=layers, moduli=solid, floor=floor, width=measures.width) for floor in FLOORS
    }
    near = np.abs(x) <= COMPARED * np.sqrt(3.0) * layers
    apart = {floor: float(np.abs(response - values)[near].max() / values.max()) for floor, values in elastic.items()}
    slab = Comparison(
        floor_response=response,
        elastic=elastic[case.floor],
        x=x,
        distance=apart[case.floor],
        distance_other_floor=apart["rough" if case.floor == "smooth" else "smooth"],
    )
    return slab, full


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``slabs``."""
    base, force = parameters.base, parameters.force
    given = [(case, layers) for case in parameters.cases for layers in case.layers]
    tasks = {k: partial(compute, base, *one, force) for k, one in enumerate(given)}
    slabs, states = zip(*computed(tasks, "slabs").values(), strict=True)
    of_cases = labels(
        "slab",
        [case for case, _ in given],
        disks_per_layer="disks of a row per layer",
        friction="coefficient of friction",
        floor="smooth, or rough: friction on floor and walls too",
        gravity="how gravity was applied",
    )
    layers = {"layers": variable("slab", [layers for _, layers in given], "number of layers")}
    dataset = table(slabs, "slab").assign(layers | of_cases).merge(certificates_dataset(states, "slab"))
    return labelled({"slabs": dataset.assign_attrs(force=force, stiffness_ratio=base.contact.stiffness_ratio)})


def _scene(case: DepthSeries, layers: int, base: Scene) -> Scene:
    """A slab with the loaded disk in the middle: rows and disks of a row both odd or both even."""
    disks = case.disks_per_layer * layers
    return base.updated(
        {
            "packing.layers": layers,
            "packing.disks_per_row": disks + (disks + layers) % 2,
            "contact.friction": case.friction,
            "wall.friction": case.friction if case.floor == "rough" else 0.0,
            "preparation.gravity": case.gravity,
        }
    )
