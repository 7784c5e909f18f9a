"""A force on a slightly polydisperse slab together with a torque: Fig. 18 and claim T1 (Sec. V.G).

``torques`` holds what each load adds at every contact, gravity subtracted as a vector; ``stress`` its
coarse-grained stress; ``reach`` how much the torque changes contact forces and stress at growing distances from
the load. The same packing and the same rest state serve every torque, and force and torque grow together from
zero. The largest torque is bounded: beyond about half the force times the radius the loaded disk rolls away. The
paper's "25 x 13" is read as 13 rows of 25 and 24 disks.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import stress as coarse
from granular_response.observe.difference import pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.scene import Packing, Scene
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.state import FloatArray, State
from granular_response.store.result import added_forces_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_of
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.torque.parameters import Parameters
from granular_response_paper.records import axes, column, record, table
from granular_response_paper.tasks import computed


def load(scene: Scene, rest: State) -> tuple[State, int]:
    """The state under force and torque, and the loaded disk; raises what the solvers raise."""
    problem = Problem.from_scene(scene).with_loads(rest.position)
    _, states = loaded_states(problem, rest, [1.0])
    return states[0], int(problem.load_disk[0])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``torques``, ``stress`` and ``reach``."""
    base, force, angle = parameters.base, parameters.force, np.radians(parameters.angle)
    edges, direction = np.array(parameters.distances), np.array([np.cos(angle), -np.sin(angle)])
    scenes = [base.updated({"loads": [_load(force * direction, torque)]}) for torque in parameters.torques]

    rest = computed({"rest": partial(rest_of, scenes[0])}, "rest")["rest"]
    results = computed({k: partial(load, scene, rest) for k, scene in enumerate(scenes)}, "torques")
    packing = base.packing.build()
    rest, *loaded = common_candidates([rest, *(state for state, _ in results.values())], packing.radius)
    disk = results[0][1]
    stress = _stress_dataset(packing, rest, loaded, parameters.stress_width, parameters.stress_spacing)
    datasets = {
        "torques": _states_dataset(packing, rest, loaded, disk, force * direction),
        "stress": stress,
        "reach": _reach_dataset(rest, loaded, disk, stress, edges),
    }
    coordinate = axes(torque=(parameters.torques, "applied torque, clockwise, in mean disk weights times mean radius"))
    return labelled({name: dataset.assign_coords(coordinate) for name, dataset in datasets.items()}, scenes[0])


def _load(force: FloatArray, torque: float) -> dict[str, Any]:
    """A load on the middle of the top row; the scene counts torques counter-clockwise."""
    return {"disk": "top-centre", "force": [float(f) for f in force], "torque": -torque}


def _states_dataset(packing: Packing, rest: State, loaded: Sequence[State], disk: int, force: FloatArray) -> xr.Dataset:
    turned = [state.angle[disk] - rest.angle[disk] for state in loaded]
    return added_forces_dataset([rest] * len(loaded), loaded, packing, "torque").assign(
        rotation=variable("torque", turned, "rotation of the loaded disk by the load, counter-clockwise, in radians"),
        loaded_disk=variable((), disk, "index of the loaded disk"),
        applied_force=variable("axis", force, f"applied force x, z {WEIGHTS}"),
    )


def _stress_dataset(packing: Packing, rest: State, loaded: Sequence[State], w: float, spacing: float) -> xr.Dataset:
    x = np.arange(0.0, packing.width + 0.5 * spacing, spacing)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)
    points = coarse.grid_points(x, z)
    fields = np.stack([coarse.coarse_grained_stress(coarse.load_forces(rest, s), points, w) for s in loaded])
    unit = "in weights per mean radius, compression positive"
    data = stress_components(("torque", "z", "x"), fields, unit, " of the added forces")
    data["stress_width"] = variable((), w, f"width w of the coarse-graining Gaussian {RADII}")
    coordinates = axes(x=(x, f"distance from the left wall {RADII}"), z=(z, f"height above the floor {RADII}"))
    return xr.Dataset(data, coordinates)


_WITHOUT = "of the force without torque, in a ring around the load"


@record
class Reach:
    """What the torque changes in rings around the load, each relative to what the force alone adds there."""

    force_change: FloatArray = column(
        f"sum of |change of a contact force| per sum of |added contact force| {_WITHOUT}", "torque", "ring"
    )
    stress_change: FloatArray = column(
        f"sum of |change of the stress tensor| per sum of |added stress tensor| {_WITHOUT}", "torque", "ring"
    )
    antisymmetric_change: FloatArray = column(
        f"sum of |change of the antisymmetric stress| per sum of |added pressure| {_WITHOUT}", "torque", "ring"
    )


def _reach_dataset(
    rest: State, loaded: Sequence[State], disk: int, stress: xr.Dataset, edges: FloatArray
) -> xr.Dataset:
    origin = rest.position[disk]
    names = ("stress_xx", "stress_xz", "stress_zx", "stress_zz")
    fields = np.stack([stress[name].values for name in names], axis=-1)
    tensor = fields.reshape(*fields.shape[:-1], 2, 2)
    x, z = np.meshgrid(stress["x"].values, stress["z"].values)
    antisymmetric, pressure = coarse.antisymmetric_part(tensor), coarse.pressure(tensor)
    force = np.stack([pair_force_difference(rest, state) for state in loaded])

    in_field = np.hypot(x - origin[0], z - origin[1])
    in_network = np.linalg.norm(contact_centre(rest) - origin, axis=1)

    def norm(vectors: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.norm(vectors, axis=-1))

    reach = Reach(
        ring_ratio(norm(force - force[0]), norm(force[0]), in_network, edges),
        ring_ratio(norm(fields - fields[0]), norm(fields[0]), in_field, edges),
        ring_ratio(np.abs(antisymmetric - antisymmetric[0]), np.abs(pressure[0]), in_field, edges),
    )
    middle = 0.5 * (edges[:-1] + edges[1:])
    return table({(): reach}).assign_coords(
        axes(ring=(middle, f"mean distance of the ring from the load {RADII}"))
        | {
            "ring_inner": variable("ring", edges[:-1], f"inner radius of the ring {RADII}"),
            "ring_outer": variable("ring", edges[1:], f"outer radius of the ring {RADII}"),
        }
    )


def ring_ratio(change: FloatArray, reference: FloatArray, distance: FloatArray, edges: FloatArray) -> FloatArray:
    """(k, rings) sum of ``change`` (k, ...) per sum of ``reference`` (...) where ``distance`` (...) is in a ring."""
    result = np.full((len(change), len(edges) - 1), np.nan)
    for ring, (inner, outer) in enumerate(pairwise(edges)):
        here = (distance >= inner) & (distance < outer)
        total = reference[here].sum()
        if total > 0.0:
            result[:, ring] = change[:, here].sum(axis=1) / total
    return result
