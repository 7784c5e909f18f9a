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

from granular_response.observe import stress as coarse
from granular_response.observe.difference import force_misalignment, pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.observe.profile import ROW_SPACING, force_profile, row_depth
from granular_response.scene import Packing, Scene
from granular_response.state import FloatArray, State
from granular_response.store.result import added_forces_dataset, certificates_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.studies import LoadPath
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.friction_fields.parameters import Parameters, Profiles
from granular_response_paper.harmonic import harmonic_lattice
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


#: "Near the load" in the claims: within this distance (mean radii). It is left out of distances of fields, since
#: there the discrete forces, not the medium, decide.
NEAR = 6.0
#: Contacts whose centre is at most this far from the vertical below the load are on it (mean radii).
ON_AXIS = 1.1


@record
class AddedStress:
    """What the load adds to one slab, in numbers."""

    misalignment: float = column("mean angle between added force and contact line, weighted with |force|, in degrees")
    axis_angle: float = column(
        "mean angle of the added forces below the load to the vertical, weighted with |force|, in degrees"
    )
    axis_share: float = column(
        "part of the vertical force carried by the contacts on the vertical below the load, mean over rows"
    )
    distance_to_lattice: float = column(
        "root mean square difference of sigma_zz from the harmonic lattice, per its own, "
        f"farther than {NEAR:g} radii from the load"
    )
    antisymmetric_near: float = column(
        f"largest antisymmetric part of the stress per largest pressure, within {NEAR:g} radii of the load"
    )
    antisymmetric_near_mean: float = column(
        f"root mean square antisymmetric part per root mean square pressure, within {NEAR:g} radii of the load"
    )


def axis_measures(rest: State, loaded: State, loaded_disk: int) -> tuple[float, float]:
    """``axis_angle`` (degrees) and ``axis_share`` of the vertical below the load (claim S1).

    Taken over the oblique contacts within ``ON_AXIS`` of it, from the third row gap below the load down; NaN where
    there are none. The forces of a vertical chain point along it: an angle near zero. Without friction they keep the
    30 degrees of the lattice. The share is that of the vertical force between two rows, averaged over the row gaps.
    """
    force = np.abs(pair_force_difference(rest, loaded))
    offset = contact_centre(rest) - rest.position[loaded_disk]
    row = -offset[:, 1] / (2.0 * ROW_SPACING)
    magnitude = np.linalg.norm(force, axis=1)
    angle = np.degrees(np.arctan2(force[:, 0], force[:, 1]))
    total = weighted = 0.0
    shares = []
    for gap in np.arange(2.5, row.max(), 1.0):
        here = np.abs(row - gap) < 0.25
        axis = here & (np.abs(offset[:, 0]) <= ON_AXIS)
        total += magnitude[axis].sum()
        weighted += (magnitude * angle)[axis].sum()
        shares.append(force[axis, 1].sum() / force[here, 1].sum())
    if total == 0.0:  # the slab has no rows so far below the load
        return float("nan"), float("nan")
    return float(weighted / total), float(np.mean(shares))


def stress_dataset(asked: Parameters, packing: Packing, disk: int, pairs: Sequence[tuple[State, State]]) -> xr.Dataset:
    """Of what the load on ``disk`` adds from each state at rest to the loaded one, along ``friction``."""
    contact, walls, force = asked.base.contact, asked.base.resolved_wall, asked.force
    w, spacing, middle = asked.stress_width, asked.stress_spacing, packing.position[disk]
    steps = int(min(asked.stress_half_width, 0.5 * packing.width) / spacing)
    x = spacing * np.arange(-steps, steps + 1)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)
    points = coarse.grid_points(x + middle[0], z)
    fields = np.stack([coarse.coarse_grained_stress(coarse.load_forces(a, b), points, w) / force for a, b in pairs])
    unit = np.zeros_like(packing.position)
    unit[disk, 1] = -1.0
    springs = harmonic_lattice(packing, unit, contact.normal_stiffness, walls.normal_stiffness)
    elastic = coarse.coarse_grained_stress(springs, points, w)[..., 1, 1]
    near = np.linalg.norm(points - middle, axis=-1) <= NEAR

    def mean_square(values: FloatArray) -> FloatArray:
        return np.sqrt((values**2).mean(axis=-1))

    off, antisymmetric = fields[..., 1, 1] - elastic, coarse.antisymmetric_part(fields)[:, near]
    pressure = coarse.pressure(fields)[:, near]
    of_fields = (
        mean_square(off[:, ~near]) / mean_square(elastic[~near]),
        np.abs(antisymmetric).max(axis=1) / pressure.max(axis=1),
        mean_square(antisymmetric) / mean_square(pressure),
    )
    scalars = [
        AddedStress(np.degrees(force_misalignment(a, b)), *axis_measures(a, b, disk), *numbers)
        for (a, b), *numbers in zip(pairs, *of_fields, strict=True)
    ]
    of = "of the added forces per applied force, in 1/mean radius, compression positive"
    further = variables(
        stress_zz_lattice=("z x", elastic, f"stress component zz of the harmonic lattice {of}"),
        stress_width=("", w, f"width w of the coarse-graining Gaussian {RADII}"),
        force=("", force, f"applied force {WEIGHTS}"),
        load_height=("", middle[1], f"height of the loaded disk before gravity {RADII}"),
    )
    places = axes(x=(x, f"distance from the loaded disk {RADII}"), z=(z, f"height above the floor {RADII}"))
    stress = stress_components(("friction", "z", "x"), fields, of)
    return table(scalars, "friction").assign(stress | further).assign_coords(places)
