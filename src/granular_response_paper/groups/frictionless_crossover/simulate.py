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
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.solvers.equilibrium import Rearranged
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray, State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import map_tasks
from granular_response_paper import slab_response
from granular_response_paper.groups.frictionless_crossover.parameters import Parameters

#: What is not kept of the measurements: it is about friction.
LEFT_OUT = ("third_peak", "third_peak_prominence", "sliding_contacts", "asymmetry_sign", "mobilised_contacts")

#: Dips at x = 0, per largest response, from which on a response can be said to have two peaks; the event has 0.001.
DIPS = (0.0, 0.005, 0.01, 0.02)

#: What is kept of the open region at close forces.
REGION = ("teardrop_depth", "teardrop_width", "reaches_floor", "layers", "normal_stiffness")

EVENTS = {
    "first_opening": "a contact within five lattice constants of the loaded disk is open that touches at rest",
    "crossover": "on each side of x = 0 the floor response has a peak that exceeds the response at x = 0",
    "teardrop_reaches_floor": "the connected region of opened contacts below the load includes the lowest row",
}


@dataclass(frozen=True)
class Slab:
    """An ordered frictionless slab under a force on the middle disk of its top row."""

    layers: int
    disks_per_row: int
    normal_stiffness: float

    def scene(self, base: Scene) -> Scene:
        """``base`` with this slab."""
        return base.updated(
            {
                "packing": {"layers": self.layers, "disks_per_row": self.disks_per_row},
                "contact.normal_stiffness": self.normal_stiffness,
            }
        )


@dataclass(frozen=True)
class Task:
    """A slab with everything asked of it."""

    slab: Slab
    scene: Scene
    forces: tuple[float, ...]
    tolerance: float  #: width of the brackets of events, per force at which they happen
    keep_states: bool
    dips: tuple[float, ...]  #: of which the crossover is looked for


@dataclass(frozen=True)
class Outcome:
    """What a task leaves behind."""

    slab: Slab
    forces: tuple[float, ...]
    measured: xr.Dataset
    events: Mapping[str, slab_response.Event]
    crossovers: tuple[slab_response.Event, ...]  #: by the dips of the task
    rest_asymmetry: float
    new_neighbours: int
    problem: Problem
    rest: State
    states: tuple[State, ...]  #: at the forces, if they are kept
    regions: NDArray[np.bool_] | None  #: (force, pair) pairs of the region of opened contacts


def solve(task: Task) -> Outcome:
    """Settle a slab, load it step by step, measure it and locate its events."""
    path = slab_response.LoadPath.of(task.scene, settle(task.scene))
    states = path.through(task.forces)
    measures = slab_response.Measures(path)
    happened: dict[str, Callable[[State], bool]] = {
        "first_opening": lambda state: measures.region(state).count > 0,
        "crossover": measures.double_peaked,
        "teardrop_reaches_floor": lambda state: measures.region(state).reaches_floor,
    }
    found = {
        name: slab_response.locate(
            name, path, task.forces, slab_response.Happening(happened[name], text), task.tolerance
        )
        for name, text in EVENTS.items()
    }
    crossovers = tuple(
        slab_response.locate(
            "crossover",
            path,
            task.forces,
            slab_response.Happening(partial(_dips, measures, dip), f"a dip of more than {dip:g} at x = 0"),
            task.tolerance,
        )
        for dip in task.dips
    )
    packing = path.problem.packing
    kept = [path.rest, *states] if task.keep_states else [path.rest]
    kept = common_candidates(kept, packing.radius)
    return Outcome(
        slab=task.slab,
        forces=task.forces,
        measured=slab_response.measured(measures, states),
        events=found,
        crossovers=crossovers,
        rest_asymmetry=rest_asymmetry(packing.position, path.rest, packing.width),
        new_neighbours=new_neighbours(packing.position, path.rest),
        problem=path.problem,
        rest=kept[0],
        states=tuple(kept[1:]),
        regions=np.stack([measures.region(s).contacts for s in states]) if task.keep_states else None,
    )


def _dips(measures: slab_response.Measures, dip: float, state: State) -> bool:
    return measures.dip(state) > dip


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
    main, sizes, widths, stiff = slabs(parameters)
    solved = map_tasks(solve, tasks(parameters), what="slabs")
    outcomes = {outcome.slab: outcome for outcome in solved}
    first = outcomes[main]
    return {
        "response": response(first, parameters.forces),
        "rest": slab_response.states_picture([first.rest], first.problem),
        "states": pictures(first, parameters.forces),
        "events": slab_response.events_dataset(list(first.events.values())),
        "sizes": table("slab", [outcomes[slab] for slab in sizes], parameters.size_forces),
        "regions": regions(outcomes, parameters),
        "widths": table("slab", [outcomes[slab] for slab in widths], parameters.size_forces),
        "stiffness": stiffness_table(
            [outcomes[slab] for slab in stiff], parameters.stiffness_forces, parameters.compared_stiffnesses
        ),
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


def followed(parameters: Parameters) -> list[Slab]:
    """The slabs of several depths whose open region is measured at close forces."""
    return [slab for slab in slabs(parameters)[1] if slab.layers <= parameters.region_layers]


def tasks(parameters: Parameters) -> list[Task]:
    """One task for each different slab, the longest first."""
    main, sizes, widths, stiff = slabs(parameters)
    asked: dict[Slab, set[float]] = {main: set(parameters.forces)}
    for slab in [*sizes, *widths]:
        asked.setdefault(slab, set()).update(parameters.size_forces)
    for slab in followed(parameters):
        asked[slab].update(parameters.region_forces)
    for slab in stiff:
        asked.setdefault(slab, set()).update(parameters.stiffness_forces)
    return [
        Task(
            slab=slab,
            scene=slab.scene(parameters.base),
            forces=tuple(sorted(asked[slab])),
            tolerance=parameters.tolerance if slab in (main, *stiff) else parameters.size_tolerance,
            keep_states=slab == main,
            dips=DIPS if slab in stiff else (),
        )
        for slab in sorted(asked, key=lambda s: (-s.layers * s.disks_per_row, s.normal_stiffness))
    ]


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


def regions(outcomes: Mapping[Slab, Outcome], parameters: Parameters) -> xr.Dataset:
    """The size of the open region at close forces, in slabs of several depths."""
    return table("slab", [outcomes[slab] for slab in followed(parameters)], parameters.region_forces)[list(REGION)]


def stiffness_table(outcomes: Sequence[Outcome], forces: Sequence[float], compared: tuple[float, ...]) -> xr.Dataset:
    """As :func:`table`, and how much the response at x = 0 changes between two stiffnesses (Sec. IV.C)."""
    data = table("normal_stiffness", outcomes, forces)
    soft, stiff = (data["response_at_centre"].sel(normal_stiffness=k).values for k in compared)
    data["response_change"] = variable(
        "force",
        soft / stiff - 1.0,
        "relative change of the response at x = 0 from the second to the first of compared_stiffness",
    )
    data["crossovers"] = variable(
        ("normal_stiffness", "dip", "bracket"),
        [[(one.low, one.high) for one in outcome.crossovers] for outcome in outcomes],
        f"forces {FORCE} between which the dip at x = 0 comes to exceed this one; nan if not up to the first",
    )
    data["dip"] = variable("dip", DIPS, "dip at x = 0, per largest response, from which on there are two peaks")
    data["compared_stiffness"] = variable("compared", compared, "normal stiffnesses whose responses are compared")
    return data


def response(outcome: Outcome, forces: Sequence[float]) -> xr.Dataset:
    """Measurements on one slab along ``force``."""
    data = table("slab", [outcome], forces).isel(slab=0)
    data = data.rename(floor_place="floor_disk").drop_vars([f"{name}_bracket" for name in EVENTS])
    return data.assign_coords({name: outcome.measured[name].variable for name in ("floor_disk", "interior")})


def table(dimension: str, outcomes: Sequence[Outcome], forces: Sequence[float]) -> xr.Dataset:
    """Measurements on slabs along ``dimension`` and ``force``, and the brackets of their events.

    Slabs have different numbers of floor disks: ``floor_response`` and ``x`` run over ``floor_place``, from
    left to right, and are nan beyond the last disk of a slab.
    """
    places = max(o.measured.sizes["floor_disk"] for o in outcomes)

    def padded(values: FloatArray) -> FloatArray:
        full = np.full((*values.shape[:-1], places), np.nan)
        full[..., : values.shape[-1]] = values
        return full

    grid = (dimension, "force")

    def along_grid(name: str) -> xr.Variable:
        columns = [o.measured[name].values[np.searchsorted(o.forces, forces)] for o in outcomes]
        text = outcomes[0].measured[name].attrs["long_name"]
        if name == "floor_response":
            return variable((*grid, "floor_place"), np.stack([padded(column) for column in columns]), text)
        return variable(grid, np.stack(columns), text)

    data = {name: along_grid(name) for name in map(str, outcomes[0].measured) if name not in LEFT_OUT}
    for name, text in EVENTS.items():
        brackets = [(o.events[name].low, o.events[name].high) for o in outcomes]
        data[f"{name}_bracket"] = variable(
            (dimension, "bracket"), brackets, f"forces {FORCE} between which: {text}; nan if not up to the first"
        )
    own: dict[str, tuple[Any, str]] = {
        "layers": ([o.slab.layers for o in outcomes], "number of rows of the slab"),
        "disks_per_row": ([o.slab.disks_per_row for o in outcomes], "disks in the bottom row"),
        "normal_stiffness": (
            [o.slab.normal_stiffness for o in outcomes],
            "normal stiffness of contacts of disks in mean weights per mean radius",
        ),
        "rest_asymmetry": (
            [o.rest_asymmetry for o in outcomes],
            f"largest horizontal distance of a disk at rest from its place in a symmetric state {LENGTH}",
        ),
        "new_neighbours": (
            [o.new_neighbours for o in outcomes],
            "pairs touching at rest that are no lattice neighbours",
        ),
    }
    coordinates = {name: variable(dimension, values, text) for name, (values, text) in own.items()}
    coordinates["force"] = variable("force", np.array(forces, float), f"applied force {FORCE}")
    coordinates["x"] = variable(
        (dimension, "floor_place"),
        np.stack([padded(o.measured["x"].values) for o in outcomes]),
        f"rest position from the loaded disk {LENGTH}",
    )
    dataset = xr.Dataset(data).assign_coords(coordinates)
    dataset["bracket"] = variable("bracket", ["low", "high"], "ends of a bracket")
    return dataset
