"""What a load adds inside a slab as a stress, beside the same load on a harmonic lattice; numbers for S1 to S3."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
import xarray as xr
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from granular_response.observe import stress as coarse
from granular_response.observe.difference import force_misalignment, pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.observe.profile import ROW_SPACING
from granular_response.scene import Packing
from granular_response.state import FLOOR, LEFT_WALL, RIGHT_WALL, WALL_NORMAL, FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper.datasets import stress_components
from granular_response_paper.groups.friction_fields.parameters import Parameters
from granular_response_paper.records import axes, column, record, table, variables

#: "Near the load" in the claims: within this distance (mean radii). It is left out of distances of fields, since
#: there the discrete forces, not the medium, decide.
NEAR = 6.0
#: Contacts whose centre is at most this far from the vertical below the load are on it (mean radii).
ON_AXIS = 1.1


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


def stress_dataset(asked: Parameters, packing: Packing, disk: int, pairs: Sequence[tuple[State, State]]) -> xr.Dataset:
    """Of what the load on ``disk`` adds from each state at rest to the loaded one, along ``friction``."""
    contact, walls, force = asked.base.contact, asked.base.resolved_wall, asked.force
    w, spacing, middle = asked.stress_width, asked.stress_spacing, packing.position[disk]
    steps = int(min(asked.stress_half_width, 0.5 * packing.width) / spacing)
    x = spacing * np.arange(-steps, steps + 1)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)
    points = coarse.grid_points(x + middle[0], z)
    fields = np.stack([coarse.coarse_grained_stress(coarse.load_forces(a, b), points, w) / force for a, b in pairs])
    springs = harmonic_lattice(packing, disk, contact.normal_stiffness, walls.normal_stiffness)
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
        Scalars(np.degrees(force_misalignment(a, b)), *axis_measures(a, b, disk), *numbers)
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
