"""A pile under gravity, with and without friction: Fig. 17 and claims P1 to P3 (Sec. V.F).

The symmetric equilibrium of the frictionless pile is a saddle of its energy. On both sides of it lies a minimum,
one the mirror image of the other; each has a maximum of the stress on one side that is a little higher than
the other. Both are found and stored, as the cases ``frictionless`` (higher on the left) and ``mirrored``; which
of them a pile falls into is decided by rounding. With friction there is the one symmetric state of this
preparation, the case ``frictional``.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network, peaks, teardrop
from granular_response.observe.floor import floor_disks, floor_force
from granular_response.observe.stress import coarse_grained_stress, contact_forces, grid_points
from granular_response.scene import Packing, Scene
from granular_response.solvers.energy import minimise
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import STATUSES, certificates_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.pile_dip.parameters import Parameters
from granular_response_paper.harmonic import harmonic_lattice
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

CASES = ("frictionless", "mirrored", "frictional"), "pile; the two frictionless ones are mirror images"
DIP = "is below the lower maximum beside it, per largest"


def settle(scene: Scene) -> tuple[State, ...]:
    """The rest state of a frictional pile, or both minima of a frictionless one; raises what the solvers raise."""
    problem = Problem.from_scene(scene)
    state = rest_state(problem)
    if problem.rotations:
        return (state,)
    other = minimise(problem, problem.with_static_forces(mirrored(state, problem.packing)))
    bottom = np.flatnonzero(problem.packing.row == 0)
    x = problem.packing.position[bottom, 0] - 0.5 * problem.packing.width

    def higher_on_the_right(minimum: State) -> float:
        force = floor_force(minimum, bottom)
        return float(force[x > 1e-6].max() - force[x < -1e-6].max())

    return tuple(sorted((state, other), key=higher_on_the_right))


def mirrored(state: State, packing: Packing) -> State:
    """The mirror image of the positions of a state, without forces. ValueError if the packing is not symmetric."""
    image = network.mirror_disks(packing.position, 0.5 * packing.width)
    position = state.position[image] * np.array([-1.0, 1.0]) + np.array([packing.width, 0.0])
    return replace(state, position=position, angle=-state.angle[image])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``piles`` (states and numbers of three cases), ``glued`` (contacts that cannot open) and ``stress``."""
    frictional = parameters.base
    without = frictional.updated({"contact.friction": 0.0, "wall.friction": 0.0})
    settled = computed({"without": partial(settle, without), "with": partial(settle, frictional)}, "piles")
    packing = frictional.packing.build()
    states = common_candidates([*settled["without"], *settled["with"]], packing.radius)
    piles = _piles(packing, states)
    found = {"piles": piles, "glued": _glued(piles, packing, without.contact.normal_stiffness)}
    return labelled(found | {"stress": _stress(packing, states, parameters)}, frictional)


@record
class Pile:
    """One pile at rest; a region of open contacts is on its axis."""

    position: FloatArray = column(f"disk centre x, z {RADII}", "disk", "axis")
    contact_force: FloatArray = column(f"contact force on the first disk {WEIGHTS}", "contact", "axis")
    contact_status: NDArray[np.int8] = column("contact status", "contact", attributes=STATUSES)
    wall_force: FloatArray = column(f"force of the wall on its disk {WEIGHTS}", "wall_contact", "axis")
    floor_force: FloatArray = column(f"vertical floor force {WEIGHTS}", "floor_disk")
    floor_dip: float = column(f"how far the floor force under the apex {DIP}")
    central_open_contacts: float = column("open contacts in the connected region on the axis of the pile")
    central_height: float = column(f"height of the highest contact of that region above the floor {RADII}")
    central_width: float = column(f"largest extent of one row of it {RADII}")


def _piles(packing: Packing, states: list[State]) -> xr.Dataset:
    bottom = floor_disks(states, np.flatnonzero(packing.row == 0))
    x = packing.position[bottom, 0] - 0.5 * packing.width
    found = []
    for state in states:
        floor, opened, centre = floor_force(state, bottom), ~state.pairs.touching, network.contact_centre(state)
        apex = state.position[np.argmax(state.position[:, 1])]
        region = teardrop.open_region(state, opened, apex, start=np.abs(centre[:, 0] - 0.5 * packing.width) < 2.0)
        pile = Pile(
            position=state.position,
            contact_force=state.pair_force(),
            contact_status=state.pairs.status,
            wall_force=state.wall_force(),
            floor_force=floor,
            floor_dip=peaks.central_dip(x, floor),
            central_open_contacts=region.count,
            central_height=centre[region.contacts, 1].max(initial=0.0),
            central_width=region.width,
        )
        found.append(pile)
    of_packing = variables(
        radius=("disk", packing.radius, f"disk radius {RADII}"),
        contact_disk=("contact", states[0].pairs.first, "disk that the contact force acts on"),
        contact_partner=("contact", states[0].pairs.second, "other disk"),
        wall_disk=("wall_contact", states[0].walls.first, "disk that the wall's force acts on"),
        wall_index=("wall_contact", states[0].walls.second, "wall: 0 floor, 1 left, 2 right"),
        width=("", packing.width, f"distance of the side walls {RADII}"),
    )
    coordinates = axes(case=CASES, axis=("xz", "axis labels"), floor_disk=(bottom, "index of the floor disk"))
    coordinates |= variables(x_floor=("floor_disk", x, f"position from the axis of the pile {RADII}"))
    of_piles = table(found, "case").assign(of_packing).assign_coords(coordinates)
    return of_piles.merge(certificates_dataset(states, "case"))


def _glued(piles: xr.Dataset, packing: Packing, stiffness: float) -> xr.Dataset:
    weight = np.stack([np.zeros(packing.n), -packing.mass], axis=1)
    springs = harmonic_lattice(packing, weight, stiffness, 2.0 * stiffness)
    bottom = np.flatnonzero(packing.row == 0)
    force = springs.force[-len(bottom) - 2 :][: len(bottom), 1]  # before those of the two side walls
    dip = peaks.central_dip(piles["x_floor"].values, force)
    return xr.Dataset(
        variables(
            floor_force=("floor_disk", force, f"vertical floor force of contacts that cannot open {WEIGHTS}"),
            floor_dip=("", dip, f"how far that under the apex {DIP}"),
        ),
        {name: piles[name].variable for name in ("floor_disk", "x_floor")},
    )


def _stress(packing: Packing, states: list[State], asked: Parameters) -> xr.Dataset:
    width, spacing, height, half = asked.stress_width, asked.stress_spacing, asked.dip_height, 0.5 * packing.width
    x: FloatArray = spacing * np.arange(-int(half / spacing), int(half / spacing) + 1, dtype=np.float64)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)

    def vertical(z: FloatArray) -> FloatArray:
        points = grid_points(x + half, z)
        return np.stack([coarse_grained_stress(contact_forces(state), points, width)[..., 1, 1] for state in states])

    line = vertical(np.array([height]))[:, 0]
    dips = [peaks.central_dip(x, profile) for profile in line]
    data = variables(
        stress_zz=("case z x", vertical(z), "vertical stress in weights per mean radius"),
        profile_zz=("case x", line, "vertical stress at the height of the dip, in weights per mean radius"),
        dip=("case", dips, f"how far the vertical stress on the axis {DIP}"),
        dip_height=("", height, f"height above the floor of those profiles {RADII}"),
        stress_width=("", width, f"width w of the coarse-graining Gaussian {RADII}"),
    )
    places = axes(x=(x, f"distance from the axis of the pile {RADII}"), z=(z, f"height above the floor {RADII}"))
    return xr.Dataset(data, axes(case=CASES) | places)
