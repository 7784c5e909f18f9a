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

import numpy as np
import xarray as xr

from granular_response.observe import stress as coarse
from granular_response.observe.floor import floor_disks, floor_force
from granular_response.observe.network import contact_centre, mirror_disks
from granular_response.observe.peaks import central_dip
from granular_response.observe.teardrop import open_region
from granular_response.scene import Packing, Scene
from granular_response.solve import Problem, minimise
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, STATUSES, certificates_dataset, common_candidates, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper.datasets import labelled, stress_components
from granular_response_paper.groups.pile_dip.parameters import Parameters

CASES = ("frictionless", "mirrored", "frictional")


def settle(scene: Scene) -> tuple[State, ...]:
    """The rest state of a frictional pile, or both minima of a frictionless one; raises what the solvers raise."""
    problem = Problem.from_scene(scene)
    state = rest_state(problem)
    if problem.rotations:
        return (state,)
    other = minimise(problem, problem.with_static_forces(mirrored(state, problem.packing)))
    x = problem.packing.position[:, 0] - 0.5 * problem.packing.width
    bottom = np.flatnonzero(problem.packing.row == 0)

    def higher_on_the_right(minimum: State) -> float:
        force = floor_force(minimum, bottom)
        right, left = force[x[bottom] > 1e-6], force[x[bottom] < -1e-6]  # neither in a pile of one disk
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
    found = map_tasks(settle, [without, frictional], what="piles")
    packing = frictional.packing.build()
    states = common_candidates([state for states in found for state in states], packing.radius)
    stress = _stress_dataset(packing, states, parameters.stress_width, parameters.stress_spacing, parameters.dip_height)
    datasets = {"piles": _piles_dataset(packing, states), "stress": stress}
    return labelled(datasets, frictional)


def _case() -> xr.Variable:
    return variable("case", list(CASES), "pile; the two frictionless ones are mirror images")


def _piles_dataset(packing: Packing, states: Sequence[State]) -> xr.Dataset:
    pairs, walls = states[0].pairs, states[0].walls
    bottom = floor_disks(states, np.flatnonzero(packing.row == 0))
    x = packing.position[bottom, 0] - 0.5 * packing.width
    floor = np.stack([floor_force(state, bottom) for state in states])
    scalars = np.array([_scalars(packing, state) for state in states], dtype=float).T
    texts = {
        "open_contacts": "contacts of the lattice that are open",
        "central_open_contacts": "open contacts in the connected region on the axis of the pile",
        "central_horizontal": "how many of them are horizontal on the lattice",
        "central_height": f"height of the highest contact of that region above the floor {LENGTH}",
        "central_width": f"largest extent of one row of it {LENGTH}",
    }
    asymmetry = np.abs(floor - floor[:, ::-1]).max(axis=1)
    status = np.stack([state.pairs.status for state in states])
    dims = ("case", "contact")
    return xr.Dataset(
        {
            "position": variable(
                ("case", "disk", "axis"),
                np.stack([state.position for state in states]),
                f"disk centre x, z {LENGTH}",
            ),
            "radius": variable("disk", packing.radius, f"disk radius {LENGTH}"),
            "contact_disk": variable("contact", pairs.first, "disk that the contact force acts on"),
            "contact_partner": variable("contact", pairs.second, "other disk"),
            "contact_force": variable(
                (*dims, "axis"),
                np.stack([state.pair_force() for state in states]),
                f"contact force on the first disk {FORCE}",
            ),
            "contact_status": variable(dims, status, "contact status", **STATUSES),
            "wall_disk": variable("wall_contact", walls.first, "disk that the wall's force acts on"),
            "wall_index": variable("wall_contact", walls.second, "wall: 0 floor, 1 left, 2 right"),
            "wall_force": variable(
                ("case", "wall_contact", "axis"),
                np.stack([state.wall_force() for state in states]),
                f"force of the wall on its disk {FORCE}",
            ),
            "floor_force": variable(("case", "floor_disk"), floor, f"vertical floor force {FORCE}"),
            "floor_dip": variable(
                "case",
                [central_dip(x, force) for force in floor],
                "how far the floor force under the apex is below the lower maximum beside it, per largest",
            ),
            "floor_asymmetry": variable(
                "case", asymmetry, f"largest difference of a floor force from its mirror image {FORCE}"
            ),
            "image_difference": variable(
                (),
                float(np.abs(floor[0] - floor[1, ::-1]).max()),
                f"largest difference of the two minima's floor forces after mirroring {FORCE}",
            ),
            "width": variable((), packing.width, f"distance of the side walls {LENGTH}"),
            **{
                name: variable("case", values, text)
                for (name, text), values in zip(texts.items(), scalars, strict=True)
            },
        },
        coords={
            "case": _case(),
            "axis": variable("axis", ["x", "z"], "axis labels"),
            "floor_disk": variable("floor_disk", bottom, "index of the floor disk"),
            "x_floor": variable("floor_disk", x, f"position from the axis of the pile {LENGTH}"),
        },
    ).merge(certificates_dataset(states, "case"))


def _scalars(packing: Packing, state: State) -> tuple[float, ...]:
    """The numbers of open contacts of ``_piles_dataset``, in its order."""
    opened = ~state.pairs.touching
    apex = state.position[int(np.argmax(state.position[:, 1]))]
    centre = contact_centre(state)
    start = np.abs(centre[:, 0] - 0.5 * packing.width) < 2.0
    region = open_region(state, opened, apex, start=start)
    inside = region.contacts
    row = packing.row
    horizontal = row[state.pairs.first] == row[state.pairs.second]
    height = float(centre[inside, 1].max()) if region.count else 0.0
    return (
        int(np.count_nonzero(opened)),
        region.count,
        int(np.count_nonzero(inside & horizontal)),
        height,
        region.width,
    )


def _stress_dataset(packing: Packing, states: Sequence[State], w: float, spacing: float, height: float) -> xr.Dataset:
    half = 0.5 * packing.width
    steps = int(half / spacing)
    x: FloatArray = spacing * np.arange(-steps, steps + 1, dtype=np.float64)
    z = np.arange(0.0, float(packing.position[:, 1].max()) + 1.0 + 0.5 * spacing, spacing)

    def fields(points: FloatArray) -> FloatArray:
        return np.stack([coarse.coarse_grained_stress(coarse.contact_forces(s), points, w) for s in states])

    grid = fields(coarse.grid_points(x + half, z))
    line = fields(coarse.grid_points(x + half, np.array([height])))[:, 0, :, 1, 1]
    dims = ("case", "z", "x")
    dips = [central_dip(x, profile) for profile in line]
    data = stress_components(dims, grid, "in weights per mean radius") | {
        "profile_zz": variable(
            ("case", "x"), line, "vertical stress at the height of the dip, in weights per mean radius"
        ),
        "dip": variable(
            "case", dips, "how far the vertical stress on the axis is below the lower maximum beside it, per largest"
        ),
        "dip_of_mean": variable(
            (), central_dip(x, line[:2].mean(axis=0)), "the same of the mean of the two frictionless minima"
        ),
        "dip_height": variable((), height, f"height above the floor of those profiles {LENGTH}"),
        "stress_width": variable((), w, f"width w of the coarse-graining Gaussian {LENGTH}"),
    }
    return xr.Dataset(
        data,
        coords={
            "case": _case(),
            "x": variable("x", x, f"distance from the axis of the pile {LENGTH}"),
            "z": variable("z", z, f"height above the floor {LENGTH}"),
        },
    )
