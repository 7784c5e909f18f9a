"""One slab without friction under a growing force: settled, loaded step by step, measured, its events located."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.solvers.equilibrium import Rearranged
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.studies import Happening, LoadPath, Measures
from granular_response.studies.measures import TWO_PEAKS
from granular_response.sweeps.rest import rest_state
from granular_response_paper import slab_response
from granular_response_paper.records import column, record, variables
from granular_response_paper.slab_response import Event

EVENTS = {
    "first_opening": "a contact within five lattice constants of the loaded disk is open that touches at rest",
    "crossover": TWO_PEAKS,
    "teardrop_reaches_floor": "the connected region of opened contacts below the load includes the lowest row",
}


@record
class OrderedSlab:
    """An ordered frictionless slab under a force on the middle disk of its top row."""

    layers: int = column("number of rows of the slab")
    disks_per_row: int = column("disks in the bottom row")
    normal_stiffness: float = column("normal stiffness of contacts of disks in mean weights per mean radius")

    def scene(self, base: Scene) -> Scene:
        """``base`` with this slab."""
        size = {"layers": self.layers, "disks_per_row": self.disks_per_row}
        return base.updated({"packing": size, "contact.normal_stiffness": self.normal_stiffness})


@record
class SlabResponse:
    """What a task leaves behind."""

    new_neighbours: int = column("pairs touching at rest that are no lattice neighbours")
    open_at_rest: int = column("horizontal contacts of the lattice in the central third that are open at rest")
    measured: xr.Dataset  #: along ``force``
    events: list[Event]  #: of EVENTS, then the crossover by each dip of the task
    pictures: dict[str, xr.Dataset]  #: ``rest`` and ``states`` at the forces, if they are kept


def solve(
    scene: Scene, forces: tuple[float, ...], tolerance: float, dips: Sequence[float], keep_states: bool
) -> SlabResponse:
    """Settle a slab, load it step by step, measure it and locate its events.

    ``tolerance`` is the width of the brackets of events, per force at which they happen; ``dips`` are those of which
    the crossover is looked for.
    """
    path = LoadPath.of(scene, settle(scene))
    states, rest, packing, measures = path.through(forces), path.rest, path.problem.packing, Measures(path)
    happened = (
        lambda state: measures.region(state).count > 0,
        measures.double_peaked,
        lambda state: measures.region(state).reaches_floor,
    )
    asked = {name: Happening(has, text) for has, (name, text) in zip(happened, EVENTS.items(), strict=True)}

    def exceeds(dip: float) -> Happening:
        return Happening(lambda state: measures.dip(state) > dip, "a dip at x = 0")

    asked |= {f"dip {dip:g}": exceeds(dip) for dip in dips}
    level = (network.lattice_direction(rest) == network.HORIZONTAL) & measures.near
    return SlabResponse(
        new_neighbours(packing.position, rest),
        int(np.count_nonzero(level & ~rest.pairs.touching)),
        slab_response.measured(measures, states).rename(state="force").assign_coords(force=list(forces)),
        slab_response.locate(path, forces, asked, tolerance),
        pictures(path, states, measures) if keep_states else {},
    )


def settle(scene: Scene) -> State:
    """The rest state: by dynamics, as the paper has it, where the lattice does not hold."""
    try:
        return rest_state(Problem.from_scene(scene))
    except Rearranged:
        return rest_state(Problem.from_scene(scene.updated({"protocol.method": "dynamics"})))


def new_neighbours(position: FloatArray, rest: State) -> int:
    """Touching pairs that are no neighbours on the lattice (``position``): none unless it has yielded."""
    i, j = rest.pairs.first[rest.pairs.touching], rest.pairs.second[rest.pairs.touching]
    distance = np.linalg.norm(position[i] - position[j], axis=1)
    return int(np.count_nonzero(distance > 1.5 * distance.min())) if distance.size else 0


def pictures(path: LoadPath, states: Sequence[State], measures: Measures) -> dict[str, xr.Dataset]:
    """``rest``, and ``states`` along ``force`` with the region of opened contacts in each."""
    rest, *loaded = common_candidates([path.rest, *states], path.problem.packing.radius)
    regions = np.stack([measures.region(state).contacts for state in states])
    count, horizontal = regions.sum(axis=1), network.lattice_direction(rest) == network.HORIZONTAL
    share = np.where(count > 0, (regions & horizontal).sum(axis=1) / np.maximum(count, 1), np.nan)
    inside = "1 for contacts of the connected region of opened contacts below the load"
    part = "fraction of the region's contacts that are horizontal at rest; nan without a region"
    further = variables(
        teardrop=("force contact", regions.astype(np.int8), inside), teardrop_horizontal=("force", share, part)
    )
    along = slab_response.states_picture(loaded, path.problem, "force").assign(further)
    return {"rest": slab_response.states_picture([rest], path.problem), "states": along}
