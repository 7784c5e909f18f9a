"""Ordered slabs without friction under a growing force (Sec. IV): Figs. 3, 4 and 5, and the stiffness study.

One slab is followed from the linear range to large forces with all its states kept (``response``, ``rest``,
``states``, ``events``). Other slabs tell how the region of opened contacts and the crossover depend on the
depth (``sizes``, at close forces ``regions``), on the distance of the side walls (``widths``) and on the stiffness of
the disks (``stiffness``). Each slab is settled once and all its forces are reached on one path.

What sets the size of a slab apart from the stiffness of its disks is the overlap that gravity makes at its
floor, so deep slabs are compared for the paper's stiffness and for much stiffer disks. Wide, deep or soft slabs
have no symmetric rest state: the symmetric equilibrium is a saddle, and the slab leans by thousandths to tenths
of a radius to one side or, as likely, to the other. Gravity pushes very soft disks out of
their rows (``new_neighbours``); the rest state then depends on the fall and is found by dynamics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.solvers.equilibrium import Rearranged
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import WEIGHTS, variable
from granular_response.studies import Happening, LoadPath, Measures
from granular_response.studies.measures import TWO_PEAKS
from granular_response.sweeps.rest import rest_state
from granular_response_paper import slab_response
from granular_response_paper.groups.frictionless_crossover.parameters import Parameters
from granular_response_paper.records import axes, column, record, stacked, table, variables
from granular_response_paper.slab_response import Event
from granular_response_paper.tasks import computed

#: What is not kept of the measurements: it is about friction.
LEFT_OUT = ("third_peak_prominence", "sliding_contacts", "asymmetry_sign", "mobilised_contacts")

#: Dips at x = 0, per largest response, from which on a response can be said to have two peaks; the event has 0.001.
DIPS = (0.0, 0.005, 0.01, 0.02)

#: What was found, by slab.
Found = Mapping["OrderedSlab", "SlabResponse"]


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response``, ``rest``, ``states``, ``events``, ``sizes``, ``regions``, ``widths`` and ``stiffness``."""
    asked = studies(parameters)
    outcomes = computed(
        tasks(parameters), "slabs", work=lambda one: (one.layers * one.disks_per_row, -one.normal_stiffness)
    )
    (main,), forces = asked["response"]
    first = outcomes[main]
    response = along("slab", outcomes, [main], forces).isel(slab=0).rename(floor_place="floor_disk")
    return {
        "response": response.drop_vars([f"{name}_bracket" for name in EVENTS]).assign_coords(
            {name: first.measured[name].variable for name in ("floor_disk", "interior")}
        ),
        "rest": first.pictures["rest"],
        "states": first.pictures["states"].sel(force=list(forces)),
        "events": table(first.events[: len(EVENTS)], "event"),
        "sizes": along("slab", outcomes, *asked["sizes"]),
        "regions": along("slab", outcomes, *asked["regions"])[
            ["teardrop_depth", "teardrop_width", "reaches_floor", "layers", "normal_stiffness"]
        ],
        "widths": along("slab", outcomes, *asked["widths"]),
        "stiffness": stiffnesses(outcomes, *asked["stiffness"]),
    }


def studies(parameters: Parameters) -> dict[str, tuple[list[OrderedSlab], tuple[float, ...]]]:
    """Slabs and the forces on them by dataset: the slab whose states are kept, then those of several depths, ..."""
    rows = parameters.scene.packing.build().row_count
    main = OrderedSlab(len(rows), int(rows[0]), parameters.scene.contact.normal_stiffness)
    sizes, widths = (
        [OrderedSlab(*shape, stiffness) for stiffness in parameters.size_stiffnesses for shape in shapes]
        for shapes in (parameters.sizes, parameters.widths)
    )
    return {
        "response": ([main], parameters.forces),
        "sizes": (sizes, parameters.size_forces),
        "widths": (widths, parameters.size_forces),
        "regions": ([slab for slab in sizes if slab.layers <= parameters.region_layers], parameters.region_forces),
        "stiffness": ([replace(main, normal_stiffness=k) for k in parameters.stiffnesses], parameters.stiffness_forces),
    }


def tasks(parameters: Parameters) -> dict[OrderedSlab, partial[SlabResponse]]:
    """One task for each different slab, with all forces on it."""
    asked = studies(parameters)
    forces: dict[OrderedSlab, set[float]] = {}
    for slabs, several in asked.values():
        for slab in slabs:
            forces.setdefault(slab, set()).update(several)
    (main,), stiff = asked["response"][0], asked["stiffness"][0]
    return {
        slab: partial(
            solve,
            slab.scene(parameters.base),
            tuple(sorted(of_slab)),
            parameters.tolerance if slab in (main, *stiff) else parameters.size_tolerance,
            DIPS if slab in stiff else (),
            slab == main,
        )
        for slab, of_slab in forces.items()
    }


def stiffnesses(outcomes: Found, slabs: Sequence[OrderedSlab], forces: Sequence[float]) -> xr.Dataset:
    """As :func:`along`, and the crossovers by other dips."""
    crossovers = [[(one.low, one.high) for one in outcomes[slab].events[len(EVENTS) :]] for slab in slabs]
    between = f"forces {WEIGHTS} between which the dip at x = 0 comes to exceed this one; nan if not up to the first"
    return along("normal_stiffness", outcomes, slabs, forces).assign(
        variables(
            crossovers=("normal_stiffness dip bracket", crossovers, between),
            dip=("dip", DIPS, "dip at x = 0, per largest response, from which on there are two peaks"),
        )
    )


def along(dimension: str, outcomes: Found, slabs: Sequence[OrderedSlab], forces: Sequence[float]) -> xr.Dataset:
    """Measurements on slabs along ``dimension`` and ``force``, and the brackets of their events.

    Slabs have different numbers of floor disks: ``floor_response`` and ``x`` run over ``floor_place``, from
    left to right, and are nan beyond the last disk of a slab.
    """
    each = [outcomes[slab] for slab in slabs]
    measured = [one.measured.sel(force=list(forces)) for one in each]

    def of(name: str, *dims: str) -> xr.Variable:
        values = stacked({(k,): one[name].values for k, one in enumerate(measured)})
        return variable((dimension, *dims[: values.ndim - 1]), values, measured[0][name].attrs["long_name"])

    data = {name: of(name, "force", "floor_place") for name in map(str, measured[0]) if name not in LEFT_OUT}
    for k, (name, text) in enumerate(EVENTS.items()):
        between = f"forces {WEIGHTS} between which: {text}; nan if not up to the first"
        ends = [(one.events[k].low, one.events[k].high) for one in each]
        data[f"{name}_bracket"] = variable((dimension, "bracket"), ends, between)
    return xr.Dataset(data).assign_coords(
        {
            **table(slabs, dimension).variables,
            **table(each, dimension).variables,
            **axes(force=(np.array(forces, float), f"applied force {WEIGHTS}")),
            "x": of("x", "floor_place"),
            **axes(bracket=(["low", "high"], "ends of a bracket")),
        }
    )


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
