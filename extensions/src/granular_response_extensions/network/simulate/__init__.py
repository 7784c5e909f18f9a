"""Statistics of contact networks against friction and disorder, at rest and under a load.

Forces grow with depth, so each is taken relative to the mean of its band of heights; they, and the fabric, are those of
contacts away from walls, floor and surface.

Coordination and hyperstaticity are those of the whole slab without rattlers (``observe.network.rattlers``). A contact
with a wall counts twice, as one of a body that does not move, so the isostatic values need no correction for the size:
forces follow from balance alone where their number is that of the equations,

    N_c = 2 N without friction (z = 4),    2 N_c - N_m = 3 N with friction (z = 3 for N_m = 0),

with N disks, N_c contacts and N_m fully mobilized ones, whose tangential force is known (Shundyak, van Hecke and van
Saarloos, Phys. Rev. E 75, 010301, 2007). The hyperstaticity is the excess of the left side, per equation.
"""

from __future__ import annotations

import contextlib
from functools import partial

import numpy as np
import xarray as xr

from granular_response.errors import SolveError
from granular_response.observe import network
from granular_response.observe.floor import wall_margin
from granular_response.scene import Scene, SceneError
from granular_response.state import FloatArray, State
from granular_response.studies import LoadPath
from granular_response_extensions.network.parameters import VERTICAL_MARGIN, Parameters
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles.realizations import ensemble_scene
from granular_response_paper.records import axes, column, record, table
from granular_response_paper.tasks import computed

#: Edges of the bins of forces over their mean.
FORCES = np.linspace(0.0, 6.0, 25)


@record
class NetworkStatistics:
    """Of one state; nan for one that is not found."""

    force_density: FloatArray = column("probability density of normal forces over their local mean", "force")
    tail_variation: float = column(
        "coefficient of variation of the excess over the mean of normal forces above it; 1 for an exponential"
    )
    coordination_number: float = column("contacts per disk without rattlers, those with walls twice")
    hyperstaticity: float = column("force components beyond the equations of balance, per equation")


def measure(path: LoadPath, state: State, asked: Parameters) -> NetworkStatistics:
    """Statistics of a state of a path."""
    friction, pairs, walls, width = path.scene.contact.friction, state.pairs, state.walls, path.problem.packing.width
    height, highest = network.contact_centre(state)[:, 1], state.position[:, 1].max() - VERTICAL_MARGIN
    inside = network.interior_contacts(state, width, wall_margin(width)) & pairs.touching
    inside &= (height > VERTICAL_MARGIN) & (height < highest)
    forces = relative(pairs.normal_force[inside], height[inside], asked.band)
    excess = forces[forces > 1.0] - 1.0
    loose = network.rattlers(state)
    live = pairs.touching & ~loose[pairs.first] & ~loose[pairs.second]
    live_walls = walls.touching & ~loose[walls.first]
    contacts, bearing = np.count_nonzero(live) + np.count_nonzero(live_walls), np.count_nonzero(~loose)
    limited = np.count_nonzero(pairs.near_limit(friction, asked.margin) & live)
    limited += np.count_nonzero(walls.near_limit(path.scene.wall.friction, asked.margin) & live_walls)
    components, equations = (2 * contacts - limited, 3 * bearing) if friction else (contacts, 2 * bearing)
    return NetworkStatistics(
        # of all forces those beyond the edges are a part
        force_density=np.histogram(forces, FORCES)[0] / (len(forces) * np.diff(FORCES)),
        tail_variation=float(excess.std() / excess.mean()),
        coordination_number=2.0 * contacts / bearing,
        hyperstaticity=(components - equations) / equations,
    )


def relative(force: FloatArray, height: FloatArray, band: float) -> FloatArray:
    """(m,) forces over the mean of their band of heights, bands of equal height from the lowest contact on."""
    number = np.floor((height - height.min()) / band).astype(np.int64)
    return force / (np.bincount(number, force) / np.maximum(np.bincount(number), 1))[number]


def compute(scene: Scene, asked: Parameters) -> list[NetworkStatistics]:
    """One packing at rest and, if it bears it, under the force; ``scene`` has one load, of unit force."""
    path = LoadPath.of(scene)
    disk = path.problem.load_disk[0]
    path.lowest = float(path.rest.position[disk, 1]) - asked.collapse_depth
    states = [path.rest]
    with contextlib.suppress(SolveError):
        states.append(path.at(asked.force))
    return [measure(path, state, asked) for state in states if state.position[disk, 1] >= path.lowest]


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``statistics``."""
    cases, numbers = parameters.cases, range(parameters.realizations)
    scenes = {(*at, r): ensemble_scene(parameters, case, r) for at, case in cases.items() for r in numbers}
    tasks = {at: partial(compute, scene, parameters) for at, scene in scenes.items()}
    found = {(*at, s): one for at, states in computed(tasks, "packings").items() for s, one in enumerate(states)}
    if not any(state for *_, state in found):
        raise SceneError(f"force = {parameters.force:g}: no packing bears it, must be smaller")
    data = table(found, "polydispersity", "friction", "realization", "state").assign_coords(
        axes(
            polydispersity=(parameters.polydispersities, "delta: spread of the radii"),
            friction=(parameters.frictions, "coefficient of friction, floor and walls included"),
            state=(("rest", "loaded"), "without load, and with it"),
            force=(0.5 * (FORCES[1:] + FORCES[:-1]), "normal force over its local mean, middle of the bin"),
        )
    )
    return labelled({"statistics": data.assign_attrs(load=parameters.force, band=parameters.band)}, scenes[0, 0, 0])
