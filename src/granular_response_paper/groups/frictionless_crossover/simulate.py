"""Ordered slabs without friction under a growing force (Sec. IV): Figs. 3, 4 and 5, and the stiffness study.

One slab is followed from the linear range to large forces with all its states kept (``response``, ``rest``,
``states``, ``events``). Other slabs tell how the region of opened contacts and the crossover depend on the
depth (``sizes``, at close forces ``regions``), on the distance of the side walls (``widths``) and on the stiffness of
the disks (``stiffness``). Each slab is settled once and all its forces are reached on one path.

What sets the size of a slab apart from the stiffness of its disks is the overlap that gravity makes at its
floor, so deep slabs are compared for the paper's stiffness and for much stiffer disks. Wide, deep or soft slabs
have no symmetric rest state: the symmetric equilibrium is a saddle, and the slab leans by thousandths to tenths
of a radius to one side or, as likely, to the other (``rest_asymmetry``). Gravity pushes very soft disks out of
their rows (``new_neighbours``); the rest state then depends on the fall and is found by dynamics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.solvers.equilibrium import Rearranged
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import common_candidates
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_state
from granular_response_paper import slab_response
from granular_response_paper.groups.frictionless_crossover.parameters import Parameters
from granular_response_paper.records import axes, column, record, stacked, table
from granular_response_paper.slab_response import TWO_PEAKS, Event, Happening
from granular_response_paper.tasks import computed

#: What is not kept of the measurements: it is about friction.
LEFT_OUT = ("third_peak", "third_peak_prominence", "sliding_contacts", "asymmetry_sign", "mobilised_contacts")

#: Dips at x = 0, per largest response, from which on a response can be said to have two peaks; the event has 0.001.
DIPS = (0.0, 0.005, 0.01, 0.02)

#: What is kept of the open region at close forces.
REGION = ("teardrop_depth", "teardrop_width", "reaches_floor", "layers", "normal_stiffness")

EVENTS = {
    "first_opening": "a contact within five lattice constants of the loaded disk is open that touches at rest",
    "crossover": TWO_PEAKS,
    "teardrop_reaches_floor": "the connected region of opened contacts below the load includes the lowest row",
}


@record
class Slab:
    """An ordered frictionless slab under a force on the middle disk of its top row."""

    layers: int = column("number of rows of the slab")
    disks_per_row: int = column("disks in the bottom row")
    normal_stiffness: float = column("normal stiffness of contacts of disks in mean weights per mean radius")

    @property
    def disks(self) -> int:
        """Nearly."""
        return self.layers * self.disks_per_row

    def scene(self, base: Scene) -> Scene:
        """``base`` with this slab."""
        return base.updated(
            {
                "packing": {"layers": self.layers, "disks_per_row": self.disks_per_row},
                "contact.normal_stiffness": self.normal_stiffness,
            }
        )


@record
class Rest:
    """What tells how a slab rests."""

    rest_asymmetry: float = column(
        f"largest horizontal distance of a disk at rest from its place in a symmetric state {RADII}"
    )
    new_neighbours: int = column("pairs touching at rest that are no lattice neighbours")


@record
class Outcome:
    """What a task leaves behind."""

    forces: tuple[float, ...]
    measured: xr.Dataset
    events: list[Event]  #: of EVENTS
    crossovers: list[Event]  #: by the dips of the task
    at_rest: Rest
    problem: Problem
    rest: State
    states: tuple[State, ...]  #: at the forces, if they are kept
    regions: NDArray[np.bool_] | None  #: (force, pair) pairs of the region of opened contacts


def solve(
    scene: Scene, forces: tuple[float, ...], tolerance: float, dips: Sequence[float], keep_states: bool
) -> Outcome:
    """Settle a slab, load it step by step, measure it and locate its events.

    ``tolerance`` is the width of the brackets of events, per force at which they happen; ``dips`` are those of which
    the crossover is looked for.
    """
    path = slab_response.LoadPath.of(scene, settle(scene))
    states = path.through(forces)
    measures = slab_response.Measures(path)
    happened = (
        lambda state: measures.region(state).count > 0,
        measures.double_peaked,
        lambda state: measures.region(state).reaches_floor,
    )
    asked = {name: Happening(has, text) for has, (name, text) in zip(happened, EVENTS.items(), strict=True)}
    of_dips = {f"dip {dip:g}": Happening(_exceeds(measures, dip), "a dip at x = 0") for dip in dips}
    packing = path.problem.packing
    rest, *kept = common_candidates([path.rest, *(states if keep_states else ())], packing.radius)
    return Outcome(
        forces=forces,
        measured=slab_response.measured(measures, states),
        events=slab_response.locate(path, forces, asked, tolerance),
        crossovers=slab_response.locate(path, forces, of_dips, tolerance),
        at_rest=Rest(
            rest_asymmetry(packing.position, path.rest, packing.width), new_neighbours(packing.position, path.rest)
        ),
        problem=path.problem,
        rest=rest,
        states=tuple(kept),
        regions=np.stack([measures.region(s).contacts for s in states]) if keep_states else None,
    )


def _exceeds(measures: slab_response.Measures, dip: float) -> Callable[[State], bool]:
    return lambda state: measures.dip(state) > dip


def settle(scene: Scene) -> State:
    """The rest state: by dynamics, as the paper has it, where the lattice does not hold."""
    try:
        return rest_state(Problem.from_scene(scene))
    except Rearranged:
        return rest_state(Problem.from_scene(scene.updated({"protocol.method": "dynamics"})))


def rest_asymmetry(position: FloatArray, rest: State, width: float) -> float:
    """Largest horizontal distance of a disk from where the rest state is symmetric, in radii.

    ``position`` (n, 2) is the undeformed packing. The symmetric part of the displacements is their mean with
    their mirror image in ``x = width / 2``.
    """
    mirror = network.mirror_disks(position, 0.5 * width)
    shift = rest.position[:, 0] - position[:, 0]
    return float(0.5 * np.abs(shift + shift[mirror]).max())


def new_neighbours(position: FloatArray, rest: State) -> int:
    """Touching pairs that are no neighbours on the lattice (``position``): none unless it has yielded."""
    i, j = rest.pairs.first[rest.pairs.touching], rest.pairs.second[rest.pairs.touching]
    distance = np.linalg.norm(position[i] - position[j], axis=1)
    return int(np.count_nonzero(distance > 1.5 * distance.min())) if distance.size else 0


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response``, ``rest``, ``states``, ``events``, ``sizes``, ``regions``, ``widths`` and ``stiffness``.

    SweepError
        If a slab cannot be solved.
    """
    asked = parameters
    main, sizes, widths, stiff = slabs(asked)
    # the longest first
    outcomes = computed(tasks(asked), "slabs", work=lambda slab: (slab.disks, -slab.normal_stiffness))
    first, followed = outcomes[main], [slab for slab in sizes if slab.layers <= asked.region_layers]
    return {
        "response": response(main, first, asked.forces),
        "rest": slab_response.states_picture([first.rest], first.problem),
        "states": pictures(first, asked.forces),
        "events": slab_response.events_dataset(first.events),
        "sizes": along("slab", sizes, outcomes, asked.size_forces),
        "regions": along("slab", followed, outcomes, asked.region_forces)[list(REGION)],
        "widths": along("slab", widths, outcomes, asked.size_forces),
        "stiffness": stiffnesses(stiff, outcomes, asked.stiffness_forces, asked.compared_stiffnesses),
    }


def slabs(parameters: Parameters) -> tuple[Slab, list[Slab], list[Slab], list[Slab]]:
    """The slab whose states are kept, those of several depths, of several widths, and of several stiffnesses."""
    rows = parameters.scene.packing.build().row_count
    main = Slab(len(rows), int(rows[0]), parameters.scene.contact.normal_stiffness)
    sizes, widths = (
        [Slab(layers, across, stiffness) for stiffness in parameters.size_stiffnesses for layers, across in shapes]
        for shapes in (parameters.sizes, parameters.widths)
    )
    return main, sizes, widths, [replace(main, normal_stiffness=stiffness) for stiffness in parameters.stiffnesses]


def tasks(parameters: Parameters) -> dict[Slab, partial[Outcome]]:
    """One task for each different slab, with all forces on it; open regions of not too deep ones at close forces."""
    main, sizes, widths, stiff = slabs(parameters)
    forces: dict[Slab, set[float]] = {main: set(parameters.forces)}
    for slab in [*sizes, *widths]:
        forces.setdefault(slab, set()).update(parameters.size_forces)
    for slab in sizes:
        if slab.layers <= parameters.region_layers:
            forces[slab].update(parameters.region_forces)
    for slab in stiff:
        forces.setdefault(slab, set()).update(parameters.stiffness_forces)
    return {
        slab: partial(
            solve,
            slab.scene(parameters.base),
            tuple(sorted(several)),
            parameters.tolerance if slab in (main, *stiff) else parameters.size_tolerance,
            DIPS if slab in stiff else (),
            slab == main,
        )
        for slab, several in forces.items()
    }


def pictures(outcome: Outcome, forces: Sequence[float]) -> xr.Dataset:
    """The states of a slab along ``force``, with the region of opened contacts in each."""
    assert outcome.regions is not None
    data = slab_response.states_picture(outcome.states, outcome.problem, "force")
    data["teardrop"] = variable(
        ("force", "contact"),
        outcome.regions.astype(np.int8),
        "1 for contacts of the connected region of opened contacts below the load",
    )
    horizontal = network.lattice_direction(outcome.rest) == network.HORIZONTAL
    count = outcome.regions.sum(axis=1)
    data["teardrop_horizontal"] = variable(
        "force",
        np.where(count > 0, (outcome.regions & horizontal).sum(axis=1) / np.maximum(count, 1), np.nan),
        "fraction of the region's contacts that are horizontal at rest; nan without a region",
    )
    return data.isel(force=np.searchsorted(outcome.forces, forces))


def stiffnesses(
    slabs: Sequence[Slab], outcomes: Mapping[Slab, Outcome], forces: Sequence[float], compared: tuple[float, ...]
) -> xr.Dataset:
    """As :func:`along`, and how much the response at x = 0 changes between two stiffnesses (Sec. IV.C)."""
    data = along("normal_stiffness", slabs, outcomes, forces)
    soft, stiff = (data["response_at_centre"].sel(normal_stiffness=k).values for k in compared)
    data["response_change"] = variable(
        "force",
        soft / stiff - 1.0,
        "relative change of the response at x = 0 from the second to the first of compared_stiffness",
    )
    data["crossovers"] = variable(
        ("normal_stiffness", "dip", "bracket"),
        [[(one.low, one.high) for one in outcomes[slab].crossovers] for slab in slabs],
        f"forces {WEIGHTS} between which the dip at x = 0 comes to exceed this one; nan if not up to the first",
    )
    data["dip"] = variable("dip", DIPS, "dip at x = 0, per largest response, from which on there are two peaks")
    data["compared_stiffness"] = variable("compared", compared, "normal stiffnesses whose responses are compared")
    return data


def response(slab: Slab, outcome: Outcome, forces: Sequence[float]) -> xr.Dataset:
    """Measurements on one slab along ``force``."""
    data = along("slab", [slab], {slab: outcome}, forces).isel(slab=0)
    data = data.rename(floor_place="floor_disk").drop_vars([f"{name}_bracket" for name in EVENTS])
    return data.assign_coords({name: outcome.measured[name].variable for name in ("floor_disk", "interior")})


def along(
    dimension: str, slabs: Sequence[Slab], outcomes: Mapping[Slab, Outcome], forces: Sequence[float]
) -> xr.Dataset:
    """Measurements on slabs along ``dimension`` and ``force``, and the brackets of their events.

    Slabs have different numbers of floor disks: ``floor_response`` and ``x`` run over ``floor_place``, from
    left to right, and are nan beyond the last disk of a slab.
    """
    each = [outcomes[slab] for slab in slabs]
    measured = [one.measured.isel(state=np.searchsorted(one.forces, forces)) for one in each]

    def of(name: str, *dims: str) -> xr.Variable:
        values = stacked({(k,): one[name].values for k, one in enumerate(measured)})
        return variable((dimension, *dims), values, measured[0][name].attrs["long_name"])

    places = {"floor_response": ("floor_place",)}
    data = {name: of(name, "force", *places.get(name, ())) for name in map(str, measured[0]) if name not in LEFT_OUT}
    for k, (name, text) in enumerate(EVENTS.items()):
        data[f"{name}_bracket"] = variable(
            (dimension, "bracket"),
            [(one.events[k].low, one.events[k].high) for one in each],
            f"forces {WEIGHTS} between which: {text}; nan if not up to the first",
        )
    return (
        xr.Dataset(data)
        .assign_coords(table(slabs, dimension).variables)
        .assign_coords(table([one.at_rest for one in each], dimension).variables)
        .assign_coords(
            axes(force=(np.array(forces, float), f"applied force {WEIGHTS}"))
            | {"x": of("x", "floor_place")}
            | axes(bracket=(["low", "high"], "ends of a bracket"))
        )
    )
