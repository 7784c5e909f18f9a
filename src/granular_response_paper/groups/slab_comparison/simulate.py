"""The response to a small force beside that of an elastic slab, as the number of layers grows (Sec. II.A, Fig. 1a).

A lattice of equal bonds is isotropic in the long run, so the floor response of a packing that loses no contact must
approach the elastic solution of its own moduli and floor. ``slabs`` holds both for packings of growing depth and their
distance; the distance to the solution with the other kind of floor says how much a distance means.

What keeps a packing from it is stored too: contacts that are open at rest (beside smooth walls gravity opens some,
in a part of the slab that does not shrink with depth; a sudden fall on a rough floor can open a row in the middle)
and contacts that slide (gravity that grows slowly leaves some at the Coulomb limit).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.state import SLIDING, FloatArray, State
from granular_response.store.result import LENGTH, certificates_dataset, variable
from granular_response.sweeps.tasks import map_tasks
from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import Floor, response_of_layers
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.slab_comparison.parameters import Case, Parameters
from granular_response_paper.slab_response import LoadPath, Measures

FLOORS: tuple[Floor, ...] = ("smooth", "rough")

#: Floor disks within this many slab heights of the load are compared; the walls are farther off.
COMPARED = 1.5


@dataclass(frozen=True)
class Outcome:
    width: float  #: distance of the side walls
    x: FloatArray  #: (floor_disk,)
    response: FloatArray  #: (floor_disk,)
    curvature: float  #: largest difference to the response to half the force, per largest response
    open_at_rest: int
    opened: int
    sliding: int
    state: State


def compute(scene: Scene, force: float) -> Outcome:
    """The response to the force and to half of it, of a scene with one load of unit force.

    Raises what the solvers raise.
    """
    path = LoadPath.of(scene)
    half, full = path.through([0.5 * force, force])
    measures = Measures(path)
    response, at_half = measures.response(full), measures.response(half)
    pairs, position = path.rest.pairs, path.problem.packing.position
    # all candidates but the pairs of neighbours on the lattice are farther apart
    distance = np.linalg.norm(position[pairs.first] - position[pairs.second], axis=1)
    neighbours = distance < 1.01 * measures.lattice_constant
    return Outcome(
        width=measures.width,
        x=measures.x,
        response=response,
        curvature=float(np.abs(response - at_half).max() / response.max()),
        open_at_rest=int(np.count_nonzero(neighbours & ~pairs.touching)),
        opened=int(np.count_nonzero(network.contact_changes(pairs, full.pairs).opened)),
        sliding=int(np.count_nonzero(full.pairs.status == SLIDING)),
        state=full,
    )


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``slabs``."""
    base, force = parameters.base, parameters.force
    ratio = base.contact.stiffness_ratio
    slabs = [(case, layers) for case in parameters.cases for layers in case.layers]
    scenes = [_scene(case, layers, base) for case, layers in slabs]
    outcomes = map_tasks(partial(compute, force=force), scenes)
    return labelled({"slabs": _dataset(slabs, outcomes, ratio, force)})


def _scene(case: Case, layers: int, base: Scene) -> Scene:
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


def _dataset(slabs: list[tuple[Case, int]], outcomes: list[Outcome], ratio: float, force: float) -> xr.Dataset:
    longest = max(len(outcome.x) for outcome in outcomes)

    def padded(values: list[FloatArray]) -> FloatArray:
        """(slab, floor_disk), nan behind the last disk of a row."""
        return np.stack([np.pad(v, (0, longest - len(v)), constant_values=np.nan) for v in values])

    own, distance, other = [], [], []
    for (case, layers), outcome in zip(slabs, outcomes, strict=True):
        solid = lattice.moduli(Springs.uniform(1.0, ratio if case.friction > 0.0 else 0.0), "free")
        elastic = {
            floor: response_of_layers(outcome.x, layers=layers, moduli=solid, floor=floor, width=outcome.width)
            for floor in FLOORS
        }
        near = np.abs(outcome.x) <= COMPARED * np.sqrt(3.0) * layers
        apart = {
            floor: float(np.abs(outcome.response - values)[near].max() / values.max())
            for floor, values in elastic.items()
        }
        own.append(elastic[case.floor])
        distance.append(apart[case.floor])
        other.append(apart["rough" if case.floor == "smooth" else "smooth"])

    def column(values: list[Any], long_name: str) -> xr.Variable:
        return variable("slab", values, long_name)

    along = ("slab", "floor_disk")
    compared = f"largest difference within {COMPARED:g} slab heights of the load, per largest elastic response"
    certificates = certificates_dataset([outcome.state for outcome in outcomes], "slab")
    return xr.Dataset(
        {
            "floor_response": variable(along, padded([o.response for o in outcomes]), "floor response per force"),
            "elastic": variable(along, padded(own), "share of the elastic slab with the same moduli, floor and walls"),
            "x": variable(along, padded([o.x for o in outcomes]), f"position from the loaded disk {LENGTH}"),
            "distance": column(distance, f"packing and elastic slab: {compared}"),
            "distance_other_floor": column(other, f"packing and elastic slab with the other floor: {compared}"),
            "nonlinearity": column(
                [o.curvature for o in outcomes], "largest change from half the force, per largest response"
            ),
            "response_sum": column([float(o.response.sum()) for o in outcomes], "sum of the floor response"),
            "open_at_rest": column([o.open_at_rest for o in outcomes], "neighbours that do not touch at rest"),
            "opened": column([o.opened for o in outcomes], "contacts that the force opens"),
            "sliding": column([o.sliding for o in outcomes], "contacts of disks that slide under the force"),
            "layers": column([layers for _, layers in slabs], "number of layers"),
            "disks_per_layer": column([case.disks_per_layer for case, _ in slabs], "disks of a row per layer"),
            "friction": column([case.friction for case, _ in slabs], "coefficient of friction"),
            "floor": column([case.floor for case, _ in slabs], "smooth, or rough: friction on floor and walls too"),
            "gravity": column([case.gravity for case, _ in slabs], "how gravity was applied"),
            **certificates.data_vars,
        },
        attrs={"force": force, "stiffness_ratio": ratio},
    )
