"""What a load adds inside a slab as a stress, beside the same load on a harmonic lattice; numbers for S1 to S3."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response.observe import stress as coarse
from granular_response.observe.difference import force_misalignment, pair_force_difference
from granular_response.observe.network import contact_centre
from granular_response.observe.profile import ROW_SPACING
from granular_response.scene import Packing
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper.datasets import stress_components
from granular_response_paper.groups.friction_fields.parameters import Parameters
from granular_response_paper.harmonic import harmonic_lattice
from granular_response_paper.records import axes, column, record, table, variables

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
