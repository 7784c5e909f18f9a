"""A pile under gravity, with and without friction: Fig. 17 and claims P1 to P3 (Sec. V.F).

The symmetric equilibrium of the frictionless pile is a saddle of its energy. On both sides of it lies a minimum,
one the mirror image of the other; each has a maximum of the stress on one side that is a little higher than
the other. Both are found and stored, as the cases ``frictionless`` (higher on the left) and ``mirrored``; which
of them a pile falls into is decided by rounding. With friction there is the one symmetric state of this
preparation, the case ``frictional``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import stress as coarse
from granular_response.observe.floor import floor_disks, floor_force
from granular_response.observe.network import contact_centre, mirror_disks
from granular_response.observe.peaks import central_dip
from granular_response.observe.teardrop import open_region
from granular_response.scene import Packing, Scene
from granular_response.solvers.energy import minimise
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import STATUSES, certificates_dataset, common_candidates
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.sweeps.rest import rest_state
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.pile_dip.parameters import Parameters
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

CASES = ("frictionless", "mirrored", "frictional")
OF_CASES = (CASES, "pile; the two frictionless ones are mirror images")


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
        right, left = force[x > 1e-6], force[x < -1e-6]  # neither in a pile of one disk
        return float(right.max(initial=0.0) - left.max(initial=0.0))

    first, second = sorted((state, other), key=higher_on_the_right)
    return first, second


def mirrored(state: State, packing: Packing) -> State:
    """The mirror image of the positions of a state at rest; forces are left to be computed.

    Raises ValueError if the packing is not symmetric.
    """
    image = mirror_disks(packing.position, 0.5 * packing.width)
    position = state.position[image] * np.array([-1.0, 1.0]) + np.array([packing.width, 0.0])
    return replace(state, position=position, angle=-state.angle[image])


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``piles`` (states and numbers of the three cases) and ``stress``."""
    frictional = parameters.base
    without = frictional.updated({"contact.friction": 0.0, "wall.friction": 0.0})
    found = computed({"without": partial(settle, without), "with": partial(settle, frictional)}, "piles")
    packing = frictional.packing.build()
    states = common_candidates([state for states in found.values() for state in states], packing.radius)
    datasets = {"piles": _piles_dataset(packing, states), "stress": _stress_dataset(packing, states, parameters)}
    return labelled(datasets, frictional)


@record
class Pile:
    """One pile at rest; a region of open contacts is on its axis."""

    position: FloatArray = column(f"disk centre x, z {RADII}", "disk", "axis")
    contact_force: FloatArray = column(f"contact force on the first disk {WEIGHTS}", "contact", "axis")
    contact_status: NDArray[np.int8] = column("contact status", "contact", attributes=STATUSES)
    wall_force: FloatArray = column(f"force of the wall on its disk {WEIGHTS}", "wall_contact", "axis")
    floor_force: FloatArray = column(f"vertical floor force {WEIGHTS}", "floor_disk")
    floor_dip: float = column(
        "how far the floor force under the apex is below the lower maximum beside it, per largest"
    )
    floor_asymmetry: float = column(f"largest difference of a floor force from its mirror image {WEIGHTS}")
    open_contacts: float = column("contacts of the lattice that are open")
    central_open_contacts: float = column("open contacts in the connected region on the axis of the pile")
    central_horizontal: float = column("how many of them are horizontal on the lattice")
    central_height: float = column(f"height of the highest contact of that region above the floor {RADII}")
    central_width: float = column(f"largest extent of one row of it {RADII}")

    @classmethod
    def of(cls, packing: Packing, state: State, bottom: NDArray[np.intp], x: FloatArray) -> Pile:
        """With the floor disks ``bottom`` at ``x`` from the axis."""
        floor = floor_force(state, bottom)
        opened = ~state.pairs.touching
        apex = state.position[int(np.argmax(state.position[:, 1]))]
        centre = contact_centre(state)
        start = np.abs(centre[:, 0] - 0.5 * packing.width) < 2.0
        region = open_region(state, opened, apex, start=start)
        inside, row = region.contacts, packing.row
        horizontal = row[state.pairs.first] == row[state.pairs.second]
        return cls(
            position=state.position,
            contact_force=state.pair_force(),
            contact_status=state.pairs.status,
            wall_force=state.wall_force(),
            floor_force=floor,
            floor_dip=central_dip(x, floor),
            floor_asymmetry=np.abs(floor - floor[::-1]).max(),
            open_contacts=int(np.count_nonzero(opened)),
            central_open_contacts=region.count,
            central_horizontal=int(np.count_nonzero(inside & horizontal)),
            central_height=centre[inside, 1].max() if region.count else 0.0,
            central_width=region.width,
        )


def _piles_dataset(packing: Packing, states: Sequence[State]) -> xr.Dataset:
    pairs, walls = states[0].pairs, states[0].walls
    bottom = floor_disks(states, np.flatnonzero(packing.row == 0))
    x = packing.position[bottom, 0] - 0.5 * packing.width
    piles = [Pile.of(packing, state, bottom, x) for state in states]
    image = np.abs(piles[0].floor_force - piles[1].floor_force[::-1]).max()
    of_packing = variables(
        radius=("disk", packing.radius, f"disk radius {RADII}"),
        contact_disk=("contact", pairs.first, "disk that the contact force acts on"),
        contact_partner=("contact", pairs.second, "other disk"),
        wall_disk=("wall_contact", walls.first, "disk that the wall's force acts on"),
        wall_index=("wall_contact", walls.second, "wall: 0 floor, 1 left, 2 right"),
        image_difference=("", image, f"largest difference of the two minima's floor forces after mirroring {WEIGHTS}"),
        width=("", packing.width, f"distance of the side walls {RADII}"),
    )
    coordinates = axes(case=OF_CASES, axis=("xz", "axis labels"), floor_disk=(bottom, "index of the floor disk"))
    places = variables(x_floor=("floor_disk", x, f"position from the axis of the pile {RADII}"))
    dataset = table(piles, "case").assign(of_packing).assign_coords(coordinates | places)
    return dataset.merge(certificates_dataset(states, "case"))


def _stress_dataset(packing: Packing, states: Sequence[State], asked: Parameters) -> xr.Dataset:
    w, spacing, height, half = asked.stress_width, asked.stress_spacing, asked.dip_height, 0.5 * packing.width
    steps = int(half / spacing)
    x: FloatArray = spacing * np.arange(-steps, steps + 1, dtype=np.float64)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)

    def fields(z: FloatArray) -> FloatArray:
        points = coarse.grid_points(x + half, z)
        return np.stack([coarse.coarse_grained_stress(coarse.contact_forces(s), points, w) for s in states])

    line = fields(np.array([height]))[:, 0, :, 1, 1]
    dips, of_mean = [central_dip(x, profile) for profile in line], central_dip(x, line[:2].mean(axis=0))
    below = "how far the vertical stress on the axis is below the lower maximum beside it, per largest"
    along = "vertical stress at the height of the dip, in weights per mean radius"
    further = variables(
        profile_zz=("case x", line, along),
        dip=("case", dips, below),
        dip_of_mean=("", of_mean, "the same of the mean of the two frictionless minima"),
        dip_height=("", height, f"height above the floor of those profiles {RADII}"),
        stress_width=("", w, f"width w of the coarse-graining Gaussian {RADII}"),
    )
    coordinates = axes(
        case=OF_CASES,
        x=(x, f"distance from the axis of the pile {RADII}"),
        z=(z, f"height above the floor {RADII}"),
    )
    stress = stress_components(("case", "z", "x"), fields(z), "in weights per mean radius")
    return xr.Dataset(stress | further, coordinates)
