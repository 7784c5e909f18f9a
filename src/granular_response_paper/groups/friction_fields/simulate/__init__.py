"""Forces and stress inside an ordered slab, with and without friction (Sec. V.D): Figs. 13, 14 and 15.

``forces`` holds what the load adds at every contact, gravity subtracted as a vector; ``stress`` its coarse-grained
stress with numbers for claims S1 to S3, beside the same load on a harmonic lattice; ``profiles`` the
magnitudes of the added forces at some depths under a larger force (claim S4).

The larger force is applied by dynamics from rest, as in the paper: there friction makes several equilibria, and
the transient chooses one. The rest state of a slab serves both forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr

from granular_response.observe.profile import force_profile, row_depth
from granular_response.scene import Scene
from granular_response.state import FloatArray, State
from granular_response.store.result import added_forces_dataset, certificates_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.studies import LoadPath
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.friction_fields.parameters import Parameters, Profiles
from granular_response_paper.groups.friction_fields.simulate.stress import ON_AXIS, stress_dataset
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

FRICTION = "coefficient of friction between disks and with the walls"


@record
class Profile:
    """The added forces at one depth."""

    contact_x: FloatArray = column(f"position of the contact from the loaded disk {RADII}", "point")
    magnitude: FloatArray = column(f"magnitude of the added contact force {WEIGHTS}", "point")
    axis_magnitude: float = column("largest magnitude below the load per largest at that depth")

    @classmethod
    def of(cls, where: FloatArray, size: FloatArray) -> Profile:
        """Of the contacts at ``where`` from the loaded disk; nan where the slab is not so deep."""
        if not len(where):
            return cls(where, size, float("nan"))
        on_axis = size[np.abs(where) <= ON_AXIS].max(initial=0.0)
        return cls(where, size, on_axis / size.max())


def load(scene: Scene, force: float, profile_force: float | None) -> tuple[State, ...]:
    """A slab at rest, under the ``force`` and, if it is given, by the ``profile_force`` from rest.

    Raises what the solvers raise.
    """
    path = LoadPath.of(scene)
    literal = scene.updated({"protocol.method": "dynamics"}) if scene.contact.friction > 0.0 else scene
    further = (LoadPath.of(literal, path.rest).at(profile_force),) if profile_force else ()
    return path.rest, path.at(force), *further


def profiles_dataset(asked: Profiles, disk: int, radius: FloatArray, results: Sequence[Sequence[State]]) -> xr.Dataset:
    """Of the forces that the load on ``disk`` adds from the first of some states to the last, along ``friction``."""
    depth = [row_depth(row) for row in asked.rows]
    found: dict[tuple[int, int], Profile] = {}
    for k, (before, *_, after) in enumerate(results):
        rest, loaded = common_candidates([before, after], radius)  # dynamics may have listed them anew on the way
        found |= {(k, r): Profile.of(*force_profile(rest, loaded, disk, below)) for r, below in enumerate(depth)}
    rows = variables(
        row=("row", asked.rows, "rows below the loaded disk"),
        depth=("row", depth, f"depth below the loaded disk {RADII}"),
    )
    data = table(found, "friction", "row").assign(force=variable((), asked.force, f"applied force {WEIGHTS}"))
    certificates = certificates_dataset([states[-1] for states in results], "friction")
    return data.assign_coords(rows).merge(certificates).assign_coords(axes(friction=(asked.frictions, FRICTION)))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``forces``, ``stress`` and ``profiles``."""
    base, force, of_profiles = parameters.base, parameters.force, parameters.profiles
    tasks = {}
    for mu in parameters.frictions:
        scene = base.updated({"contact.friction": mu, "wall.friction": mu})
        tasks[mu] = partial(load, scene, force, of_profiles.force if mu in of_profiles.frictions else None)
    results = computed(tasks, "frictions")
    packing = base.packing.build()
    listed = common_candidates([state for states in results.values() for state in states[:2]], packing.radius)
    rest, loaded = listed[::2], listed[1::2]
    disk = int(LoadPath.of(base, rest[0]).problem.load_disk[0])
    forces = added_forces_dataset(rest, loaded, packing, "friction").assign(
        loaded_disk=variable((), disk, "index of the loaded disk"),
        force=variable((), force, f"applied force {WEIGHTS}"),
    )
    stress = stress_dataset(parameters, packing, disk, list(zip(rest, loaded, strict=True)))
    frictions = axes(friction=(results, FRICTION))
    chosen = [results[mu] for mu in of_profiles.frictions]
    datasets = {
        "forces": forces.assign_coords(frictions),
        "stress": stress.assign_coords(frictions),
        "profiles": profiles_dataset(of_profiles, disk, packing.radius, chosen),
    }
    return labelled(datasets, base)
