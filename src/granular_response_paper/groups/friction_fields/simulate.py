"""Forces and stress inside an ordered slab, with and without friction (Sec. V.D): Figs. 13, 14 and 15.

``forces`` holds what the load adds at every contact, gravity subtracted as a vector; ``stress`` its coarse-grained
stress with numbers for claims S1 to S3, beside the same load on a harmonic lattice; ``profiles`` the
magnitudes of the added forces at some depths under a larger force (claim S4).

The larger force is applied by dynamics from rest, as in the paper: there friction makes several equilibria, and
the transient chooses one. The rest state of a slab serves both forces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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
from granular_response.store.result import (
    FORCE,
    LENGTH,
    added_forces_dataset,
    certificates_dataset,
    common_candidates,
    variable,
)
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.friction_fields.parameters import Parameters
from granular_response_paper.slab_response import LoadPath

#: "Near the load" in the claims: within this distance (mean radii). It is left out of distances of fields, since
#: there the discrete forces, not the medium, decide.
NEAR = 6.0
#: Contacts whose centre is at most this far from the vertical below the load are on it (mean radii).
ON_AXIS = 1.1

_SCALARS = {
    "misalignment": "mean angle between added force and contact line, weighted with |force|, in degrees",
    "axis_angle": "mean angle of the added forces below the load to the vertical, weighted with |force|, in degrees",
    "axis_share": "part of the vertical force carried by the contacts on the vertical below the load, mean over rows",
    "distance_to_lattice": "root mean square difference of sigma_zz from the harmonic lattice, per its own, "
    f"farther than {NEAR:g} radii from the load",
    "antisymmetric_near": "largest antisymmetric part of the stress per largest pressure, "
    f"within {NEAR:g} radii of the load",
    "antisymmetric_near_mean": "root mean square antisymmetric part per root mean square pressure, "
    f"within {NEAR:g} radii of the load",
}


@dataclass(frozen=True)
class Friction:
    """One coefficient of friction: a scene with one load of unit force, and the forces put on it."""

    scene: Scene
    force: float
    profile_force: float | None  #: applied by dynamics from rest; None: not asked for


@dataclass(frozen=True)
class Loaded:
    """The states of one slab: at rest, under the force, under the profile force."""

    rest: State
    loaded: State
    profile: State | None
    loaded_disk: int


def load(task: Friction) -> Loaded:
    """Settle a slab and load it; raises what the solvers raise."""
    path = LoadPath.of(task.scene)
    loaded = path.at(task.force)
    profile = None
    if task.profile_force is not None:
        literal = task.scene
        if task.scene.contact.friction > 0.0:
            literal = literal.updated({"protocol.method": "dynamics"})
        profile = LoadPath.of(literal, path.rest).at(task.profile_force)
    return Loaded(path.rest, loaded, profile, int(path.problem.load_disk[0]))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``forces``, ``stress`` and ``profiles``."""
    base, frictions, force = parameters.base, parameters.frictions, parameters.force
    of_profiles, profile_force = parameters.profiles.frictions, parameters.profiles.force
    tasks = [
        Friction(
            base.updated({"contact.friction": mu, "wall.friction": mu}),
            force,
            profile_force if mu in of_profiles else None,
        )
        for mu in frictions
    ]
    results: list[Loaded] = map_tasks(load, tasks, what="frictions")

    packing = base.packing.build()
    listed = common_candidates([s for one in results for s in (one.rest, one.loaded)], packing.radius)
    rest, loaded = listed[::2], listed[1::2]
    disk = results[0].loaded_disk
    coordinate = variable("friction", frictions, "coefficient of friction between disks and with the walls")
    scalars = _scalars(rest, loaded, disk)
    stress = _stress_dataset(parameters, base, rest, loaded, disk, force, scalars)
    datasets = {
        "forces": _forces_dataset(packing, rest, loaded, disk, force).assign_coords(friction=coordinate),
        "stress": stress.assign_coords(friction=coordinate),
    }
    if of_profiles:
        chosen = [results[frictions.index(mu)] for mu in of_profiles]
        datasets["profiles"] = _profiles_dataset(
            packing, chosen, parameters.profiles.rows, profile_force
        ).assign_coords(friction=variable("friction", of_profiles, coordinate.attrs["long_name"]))
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
    tolerance = 1e-6
    touching = (
        np.flatnonzero(position[:, 1] < half + tolerance),
        np.flatnonzero(position[:, 0] < half + tolerance),
        np.flatnonzero(position[:, 0] > packing.width - half - tolerance),
    )
    wall_disk = np.concatenate(touching)
    wall = np.repeat([FLOOR, LEFT_WALL, RIGHT_WALL], [len(disks) for disks in touching])
    normal = branch / np.linalg.norm(branch, axis=1, keepdims=True)

    def compression(disks: NDArray, other: NDArray | None, direction: FloatArray) -> sp.csr_array:
        """Maps displacements [x | z] to the changes of the distances along ``direction``."""
        row = np.arange(len(disks))
        entries = [(disks, direction)] if other is None else [(disks, direction), (other, -direction)]
        rows = np.concatenate([row for _ in entries for _ in range(2)])
        columns = np.concatenate([d + axis * n for d, _ in entries for axis in range(2)])
        values = np.concatenate([v[:, axis] for _, v in entries for axis in range(2)])
        return sp.csr_array((values, (rows, columns)), shape=(len(disks), 2 * n))

    bonds = compression(first, second, normal)
    holds = compression(wall_disk, None, WALL_NORMAL[wall])
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

    Taken over the oblique contacts within ``ON_AXIS`` of it, from the third row gap below the load down. The
    NaN where there are none. The
    forces of a vertical chain point along it: an angle near zero. Without friction they keep the 30 degrees
    of the lattice. The share is that of the vertical force between two rows, averaged over the row gaps.
    """
    force = np.abs(pair_force_difference(rest, loaded))
    offset = contact_centre(rest) - rest.position[loaded_disk]
    row = -offset[:, 1] / (2.0 * ROW_SPACING)
    gaps = np.arange(2.5, row.max(), 1.0)
    magnitude = np.linalg.norm(force, axis=1)
    angle = np.degrees(np.arctan2(force[:, 0], force[:, 1]))
    total = weighted = 0.0
    shares = []
    for gap in gaps:
        here = np.abs(row - gap) < 0.25
        axis = here & (np.abs(offset[:, 0]) <= ON_AXIS)
        total += magnitude[axis].sum()
        weighted += (magnitude * angle)[axis].sum()
        shares.append(force[axis, 1].sum() / force[here, 1].sum())
    if total == 0.0:  # the slab has no rows so far below the load
        return float("nan"), float("nan")
    return float(weighted / total), float(np.mean(shares))


def _scalars(rest: Sequence[State], loaded: Sequence[State], disk: int) -> dict[str, list[float]]:
    rows = [
        (np.degrees(force_misalignment(a, b)), *axis_measures(a, b, disk)) for a, b in zip(rest, loaded, strict=True)
    ]
    columns = np.array(rows).T.tolist()
    return dict(zip(("misalignment", "axis_angle", "axis_share"), columns, strict=True))


def _forces_dataset(
    packing: Packing, rest: Sequence[State], loaded: Sequence[State], disk: int, force: float
) -> xr.Dataset:
    return added_forces_dataset(rest, loaded, packing, "friction").assign(
        loaded_disk=variable((), disk, "index of the loaded disk"),
        force=variable((), force, f"applied force {FORCE}"),
    )


def _stress_dataset(
    parameters: Parameters,
    base: Scene,
    rest: Sequence[State],
    loaded: Sequence[State],
    disk: int,
    force: float,
    scalars: Mapping[str, Sequence[float]],
) -> xr.Dataset:
    packing = base.packing.build()
    w, spacing = parameters.stress_width, parameters.stress_spacing
    middle = packing.position[disk]
    half = min(parameters.stress_half_width, 0.5 * packing.width)
    steps = int(half / spacing)
    x = spacing * np.arange(-steps, steps + 1)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)
    points = coarse.grid_points(x + middle[0], z)
    fields = np.stack(
        [
            coarse.coarse_grained_stress(coarse.load_forces(a, b), points, w) / force
            for a, b in zip(rest, loaded, strict=True)
        ]
    )
    wall = base.resolved_wall.normal_stiffness
    reference = coarse.coarse_grained_stress(
        harmonic_lattice(packing, disk, base.contact.normal_stiffness, wall), points, w
    )
    distance = np.linalg.norm(points - middle, axis=-1)
    near, far = distance <= NEAR, distance > NEAR
    antisymmetric, pressure = coarse.antisymmetric_part(fields), coarse.pressure(fields)
    vertical, elastic = fields[..., 1, 1], reference[..., 1, 1]

    def mean_square(values: FloatArray) -> FloatArray:
        return np.sqrt((values**2).mean(axis=-1))

    values = {
        **scalars,
        "distance_to_lattice": mean_square((vertical - elastic)[:, far]) / mean_square(elastic[far]),
        "antisymmetric_near": np.abs(antisymmetric[:, near]).max(axis=1) / pressure[:, near].max(axis=1),
        "antisymmetric_near_mean": mean_square(antisymmetric[:, near]) / mean_square(pressure[:, near]),
    }
    dims = ("friction", "z", "x")
    of = "of the added forces per applied force, in 1/mean radius, compression positive"
    data = {name: variable("friction", values[name], text) for name, text in _SCALARS.items()}
    data |= stress_components(dims, fields, of)
    data["stress_zz_lattice"] = variable(("z", "x"), elastic, f"stress component zz of the harmonic lattice {of}")
    data["stress_width"] = variable((), w, f"width w of the coarse-graining Gaussian {LENGTH}")
    data["force"] = variable((), force, f"applied force {FORCE}")
    data["load_height"] = variable((), middle[1], f"height of the loaded disk before gravity {LENGTH}")
    return xr.Dataset(
        data,
        coords={
            "x": variable("x", x, f"distance from the loaded disk {LENGTH}"),
            "z": variable("z", z, f"height above the floor {LENGTH}"),
        },
    )


def _profiles_dataset(packing: Packing, results: Sequence[Loaded], rows: Sequence[float], force: float) -> xr.Dataset:
    found, states = [], []
    for one in results:
        assert one.profile is not None
        states.append(one.profile)
        # dynamics may have listed candidates anew on the way
        rest, loaded = common_candidates([one.rest, one.profile], packing.radius)
        found.append([force_profile(rest, loaded, one.loaded_disk, row_depth(float(row))) for row in rows])
    length = max(len(x) for profiles in found for x, _ in profiles)
    x = np.full((len(results), len(rows), length), np.nan)
    magnitude = x.copy()
    strongest = np.full(x.shape[:2], np.nan)
    axis = strongest.copy()
    for m, profiles in enumerate(found):
        for r, (where, size) in enumerate(profiles):
            if not len(where):  # the slab is not so deep
                continue
            x[m, r, : len(where)], magnitude[m, r, : len(size)] = where, size
            top = size >= size.max() * (1.0 - 1e-3)  # both of a mirror pair
            strongest[m, r] = np.abs(where[top]).mean()
            axis[m, r] = size[np.abs(where) <= ON_AXIS].max(initial=0.0) / size.max()
    dims = ("friction", "row")
    return xr.Dataset(
        {
            "contact_x": variable((*dims, "point"), x, f"position of the contact from the loaded disk {LENGTH}"),
            "magnitude": variable((*dims, "point"), magnitude, f"magnitude of the added contact force {FORCE}"),
            "strongest_x": variable(dims, strongest, f"distance of the strongest contact from x = 0 {LENGTH}"),
            "axis_magnitude": variable(dims, axis, "largest magnitude below the load per largest at that depth"),
            "force": variable((), force, f"applied force {FORCE}"),
        },
        coords={
            "row": variable("row", np.array(rows, dtype=float), "rows below the loaded disk"),
            "depth": variable("row", [row_depth(float(row)) for row in rows], f"depth below the loaded disk {LENGTH}"),
        },
    ).merge(certificates_dataset(states, "friction"))
