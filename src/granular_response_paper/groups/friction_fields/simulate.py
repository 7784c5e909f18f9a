"""Forces and stress inside an ordered slab, with and without friction (Sec. V.D): Figs. 13, 14 and 15.

``forces`` holds what the load adds at every contact, gravity subtracted as a vector; ``stress`` its coarse-grained
stress with numbers for claims S1 to S3, beside the same load on a harmonic lattice; ``profiles`` the
magnitudes of the added forces at some depths under a larger force (claim S4).

The larger force is applied by dynamics from rest, as in the paper: there friction makes several equilibria, and
the transient chooses one. The rest state of a slab serves both forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.sparse as sp
import xarray as xr
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from granular_response.observe import stress as coarse
from granular_response.observe.difference import force_misalignment, pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.observe.profile import ROW_SPACING, force_profile, row_depth
from granular_response.scene import Packing, Scene
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, FloatArray, State
from granular_response.store.result import added_forces_dataset, certificates_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.friction_fields.parameters import Parameters
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.slab_response import LoadPath
from granular_response_paper.tasks import computed

#: "Near the load" in the claims: within this distance (mean radii). It is left out of distances of fields, since
#: there the discrete forces, not the medium, decide.
NEAR = 6.0
#: Contacts whose centre is at most this far from the vertical below the load are on it (mean radii).
ON_AXIS = 1.1

FRICTION = "coefficient of friction between disks and with the walls"


@record
class Scalars:
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


@record
class Profile:
    """The added forces at one depth."""

    contact_x: FloatArray = column(f"position of the contact from the loaded disk {RADII}", "point")
    magnitude: FloatArray = column(f"magnitude of the added contact force {WEIGHTS}", "point")
    strongest_x: float = column(f"distance of the strongest contact from x = 0 {RADII}")
    axis_magnitude: float = column("largest magnitude below the load per largest at that depth")

    @classmethod
    def of(cls, where: FloatArray, size: FloatArray) -> Profile:
        """Of the contacts at ``where`` from the loaded disk; nan where the slab is not so deep."""
        if not len(where):
            return cls(where, size, float("nan"), float("nan"))
        top = size >= size.max() * (1.0 - 1e-3)  # both of a mirror pair
        on_axis = size[np.abs(where) <= ON_AXIS].max(initial=0.0)
        return cls(where, size, np.abs(where[top]).mean(), on_axis / size.max())


@dataclass(frozen=True)
class Loaded:
    """The states of one slab: at rest, under the force, under the profile force."""

    rest: State
    loaded: State
    profile: State | None
    loaded_disk: int


def load(scene: Scene, force: float, profile_force: float | None) -> Loaded:
    """Settle a slab and load it, by the ``profile_force`` from rest too; raises what the solvers raise."""
    path = LoadPath.of(scene)
    literal = scene.updated({"protocol.method": "dynamics"}) if scene.contact.friction > 0.0 else scene
    profile = None if profile_force is None else LoadPath.of(literal, path.rest).at(profile_force)
    return Loaded(path.rest, path.at(force), profile, int(path.problem.load_disk[0]))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``forces``, ``stress`` and ``profiles``."""
    base, force, of_profiles = parameters.base, parameters.force, parameters.profiles
    tasks = {}
    for mu in parameters.frictions:
        scene = base.updated({"contact.friction": mu, "wall.friction": mu})
        tasks[mu] = partial(load, scene, force, of_profiles.force if mu in of_profiles.frictions else None)
    results = computed(tasks, "frictions")

    packing = base.packing.build()
    listed = common_candidates([s for one in results.values() for s in (one.rest, one.loaded)], packing.radius)
    rest, loaded = listed[::2], listed[1::2]
    disk = results[parameters.frictions[0]].loaded_disk
    forces = added_forces_dataset(rest, loaded, packing, "friction").assign(
        loaded_disk=variable((), disk, "index of the loaded disk"),
        force=variable((), force, f"applied force {WEIGHTS}"),
    )
    datasets = {"forces": forces, "stress": _stress_dataset(parameters, base, rest, loaded, disk)}
    datasets = {name: data.assign_coords(axes(friction=(results, FRICTION))) for name, data in datasets.items()}
    if of_profiles.frictions:
        chosen = [results[mu] for mu in of_profiles.frictions]
        profiles = _profiles_dataset(packing, chosen, of_profiles.rows, of_profiles.force)
        datasets["profiles"] = profiles.assign_coords(axes(friction=(of_profiles.frictions, FRICTION)))
    return labelled(datasets, base)


def harmonic_lattice(
    packing: Packing, loaded_disk: int, normal_stiffness: float, wall_stiffness: float
) -> coarse.ContactForces:
    """Contact forces of a unit vertical load on a lattice of two-sided springs, no friction, no gravity.

    The elastic reference of Fig. 14: all bonds alike, so the medium is isotropic, and none can open. Floor and
    side walls hold the disks nearest to them by springs too. Solved to first order in the displacements.
    """
    pairs = packing.neighbour_pairs()
    if pairs is None:
        raise ValueError("packing: must be a lattice, a packing from a file has no lattice bonds")
    n, position = packing.n, packing.position
    first, second = pairs[:, 0], pairs[:, 1]
    branch = position[first] - position[second]
    half = 0.5 * float(packing.lattice_constant or 2.0)
    (x, z), within = position.T, half + 1e-6
    which, wall_disk = np.nonzero([z < within, x < within, x > packing.width - within])
    wall = np.array([FLOOR, LEFT_WALL, RIGHT_WALL])[which]
    normal = branch / np.linalg.norm(branch, axis=1, keepdims=True)

    def compression(*ends: tuple[NDArray, FloatArray]) -> sp.csr_array:
        """Maps displacements [x | z] to the changes of distances, given disks and directions at the ends of these."""
        count = len(ends[0][0])
        parts = [(np.arange(count), disks + axis * n, along[:, axis]) for disks, along in ends for axis in range(2)]
        rows, columns, values = map(np.concatenate, zip(*parts, strict=True))
        return sp.csr_array((values, (rows, columns)), shape=(count, 2 * n))

    bonds = compression((first, normal), (second, -normal))
    holds = compression((wall_disk, WALL_NORMAL[wall]))
    stiffness = normal_stiffness * (bonds.T @ bonds) + wall_stiffness * (holds.T @ holds)
    external = np.zeros(2 * n)
    external[n + loaded_disk] = -1.0
    displacement = spsolve(sp.csc_array(stiffness), external)
    force = -normal_stiffness * (bonds @ displacement)
    wall_force = -wall_stiffness * (holds @ displacement)
    return coarse.ContactForces(
        point=np.concatenate([position[first], position[wall_disk]]),
        branch=np.concatenate([branch, half * WALL_NORMAL[wall]]),
        force=np.concatenate([force[:, None] * normal, wall_force[:, None] * WALL_NORMAL[wall]]),
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


def _stress_dataset(
    parameters: Parameters, base: Scene, rest: Sequence[State], loaded: Sequence[State], disk: int
) -> xr.Dataset:
    packing, force = base.packing.build(), parameters.force
    w, spacing = parameters.stress_width, parameters.stress_spacing
    middle = packing.position[disk]
    steps = int(min(parameters.stress_half_width, 0.5 * packing.width) / spacing)
    x = spacing * np.arange(-steps, steps + 1)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)
    points = coarse.grid_points(x + middle[0], z)
    pairs = list(zip(rest, loaded, strict=True))
    fields = np.stack([coarse.coarse_grained_stress(coarse.load_forces(a, b), points, w) / force for a, b in pairs])
    springs = harmonic_lattice(packing, disk, base.contact.normal_stiffness, base.resolved_wall.normal_stiffness)
    reference = coarse.coarse_grained_stress(springs, points, w)
    distance = np.linalg.norm(points - middle, axis=-1)
    near, far = distance <= NEAR, distance > NEAR
    antisymmetric, pressure = coarse.antisymmetric_part(fields), coarse.pressure(fields)
    vertical, elastic = fields[..., 1, 1], reference[..., 1, 1]

    def mean_square(values: FloatArray) -> FloatArray:
        return np.sqrt((values**2).mean(axis=-1))

    measured = zip(
        mean_square((vertical - elastic)[:, far]) / mean_square(elastic[far]),
        np.abs(antisymmetric[:, near]).max(axis=1) / pressure[:, near].max(axis=1),
        mean_square(antisymmetric[:, near]) / mean_square(pressure[:, near]),
        strict=True,
    )
    scalars = [
        Scalars(np.degrees(force_misalignment(a, b)), *axis_measures(a, b, disk), *of_fields)
        for (a, b), of_fields in zip(pairs, measured, strict=True)
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


def _profiles_dataset(packing: Packing, results: Sequence[Loaded], rows: Sequence[float], force: float) -> xr.Dataset:
    depth = [row_depth(float(row)) for row in rows]
    found, states = {}, [one.profile for one in results if one.profile is not None]
    for k, (one, state) in enumerate(zip(results, states, strict=True)):
        # dynamics may have listed candidates anew on the way
        rest, loaded = common_candidates([one.rest, state], packing.radius)
        for r, below in enumerate(depth):
            found[k, r] = Profile.of(*force_profile(rest, loaded, one.loaded_disk, below))
    return (
        table(found, "friction", "row")
        .assign(force=variable((), force, f"applied force {WEIGHTS}"))
        .assign_coords(
            variables(
                row=("row", np.array(rows, dtype=float), "rows below the loaded disk"),
                depth=("row", depth, f"depth below the loaded disk {RADII}"),
            )
        )
        .merge(certificates_dataset(states, "friction"))
    )
