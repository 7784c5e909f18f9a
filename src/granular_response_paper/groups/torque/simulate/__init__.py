"""A force on a slightly polydisperse slab together with a torque: Fig. 18 and claim T1 (Sec. V.G).

``torques`` holds what each load adds at every contact, gravity subtracted as a vector; ``stress`` its
coarse-grained stress; ``reach`` how much the torque changes contact forces and stress at growing distances from
the load. The same packing and the same rest state serve every torque, and force and torque grow together from
zero. The largest torque is bounded: beyond about half the force times the radius the loaded disk rolls away. The
paper's "25 x 13" is read as 13 rows of 25 and 24 disks.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
import xarray as xr

from granular_response.observe import stress as coarse
from granular_response.observe.difference import pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.scene import Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.state import FloatArray, State
from granular_response.store.result import added_forces_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_of
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.torque.parameters import Parameters
from granular_response_paper.records import axes, variables
from granular_response_paper.tasks import computed


def load(scene: Scene, rest: State) -> tuple[State, int]:
    """The state under force and torque, and the loaded disk; raises what the solvers raise."""
    problem = Problem.from_scene(scene).with_loads(rest.position)
    _, states = loaded_states(problem, rest, [1.0])
    return states[0], int(problem.load_disk[0])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``torques``, ``stress`` and ``reach``."""
    p, angle = parameters, np.radians(parameters.angle)
    force = p.force * np.array([np.cos(angle), -np.sin(angle)])
    one = {"disk": "top-centre", "force": force.tolist()}
    # a scene counts torques counter-clockwise
    scenes = [p.base.updated({"loads": [one | {"torque": -torque}]}) for torque in p.torques]

    rest = computed({"rest": partial(rest_of, scenes[0])}, "rest")["rest"]
    results = computed({k: partial(load, scene, rest) for k, scene in enumerate(scenes)}, "torques")
    packing, disk = p.base.packing.build(), results[0][1]
    rest, *loaded = common_candidates([rest, *(state for state, _ in results.values())], packing.radius)

    turned = [state.angle[disk] - rest.angle[disk] for state in loaded]
    torques = added_forces_dataset([rest] * len(loaded), loaded, packing, "torque").assign(
        variables(
            rotation=("torque", turned, "rotation of the loaded disk by the load, counter-clockwise, in radians"),
            loaded_disk=("", disk, "index of the loaded disk"),
            applied_force=("axis", force, f"applied force x, z {WEIGHTS}"),
        )
    )

    x = np.arange(0.0, packing.width + 0.5 * p.stress_spacing, p.stress_spacing)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * p.stress_spacing, p.stress_spacing)
    points = coarse.grid_points(x, z)
    tensor = np.stack(
        [coarse.coarse_grained_stress(coarse.load_forces(rest, s), points, p.stress_width) for s in loaded]
    )
    unit = "in weights per mean radius, compression positive"
    stress = xr.Dataset(
        stress_components(("torque", "z", "x"), tensor, unit, " of the added forces"),
        axes(x=(x, f"distance from the left wall {RADII}"), z=(z, f"height above the floor {RADII}")),
    )

    changes = np.stack([pair_force_difference(rest, state) for state in loaded])
    in_network, in_field = (np.linalg.norm(at - rest.position[disk], axis=-1) for at in (contact_centre(rest), points))
    datasets = {
        "torques": torques,
        "stress": stress,
        "reach": _reach_dataset(changes, tensor, in_network, in_field, np.array(p.distances)),
    }
    coordinate = axes(torque=(p.torques, "applied torque, clockwise, in mean disk weights times mean radius"))
    return labelled({name: dataset.assign_coords(coordinate) for name, dataset in datasets.items()}, scenes[0])


def _reach_dataset(
    force: FloatArray, stress: FloatArray, in_network: FloatArray, in_field: FloatArray, edges: FloatArray
) -> xr.Dataset:
    """What the torque changes of forces and stresses in rings around the load, per what the force alone adds there."""

    def norm(vectors: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.norm(vectors, axis=-1))

    def in_rings(
        what: str, per: str, change: FloatArray, alone: FloatArray, distance: FloatArray
    ) -> tuple[str, FloatArray, str]:
        text = f"sum of |change of {what}| per sum of |added {per}| of the force without torque, {around}"
        return "torque ring", ring_ratio(change, alone, distance, edges), text

    around = "in a ring around the load"
    whole, turning = stress.reshape(*stress.shape[:-2], 4), coarse.antisymmetric_part(stress)
    turned, pressure = np.abs(turning - turning[0]), np.abs(coarse.pressure(stress[0]))
    changes = variables(
        force_change=in_rings("a contact force", "contact force", norm(force - force[0]), norm(force[0]), in_network),
        stress_change=in_rings("the stress tensor", "stress tensor", norm(whole - whole[0]), norm(whole[0]), in_field),
        antisymmetric_change=in_rings("the antisymmetric stress", "pressure", turned, pressure, in_field),
    )
    middle = 0.5 * (edges[:-1] + edges[1:])
    ends = variables(
        ring_inner=("ring", edges[:-1], f"inner radius of the ring {RADII}"),
        ring_outer=("ring", edges[1:], f"outer radius of the ring {RADII}"),
    )
    return xr.Dataset(changes, axes(ring=(middle, f"mean distance of the ring from the load {RADII}")) | ends)


def ring_ratio(change: FloatArray, reference: FloatArray, distance: FloatArray, edges: FloatArray) -> FloatArray:
    """(k, rings) sum of ``change`` (k, ...) per sum of ``reference`` (...) where ``distance`` (...) is in a ring."""
    result = np.full((len(change), len(edges) - 1), np.nan)
    for ring, (inner, outer) in enumerate(pairwise(edges)):
        here = (distance >= inner) & (distance < outer)
        total = reference[here].sum()
        if total > 0.0:
            result[:, ring] = change[:, here].sum(axis=1) / total
    return result
