"""Ordered slabs without friction under a growing force (Sec. IV): Figs. 3, 4 and 5, and the stiffness study.

One slab is followed from the linear range to large forces with all its states kept (``response``, ``rest``,
``states``, ``events``). Other slabs tell how the region of opened contacts and the crossover depend on the
depth (``sizes``), on the distance of the side walls (``widths``) and on the stiffness of the disks
(``stiffness``). Each slab is settled once and all its forces are reached on one path.

What sets the size of a slab apart from the stiffness of its disks is the overlap that gravity makes at its
floor, so deep slabs are compared for the paper's stiffness and for much stiffer disks. Wide, deep or soft slabs
have no symmetric rest state: the symmetric equilibrium is a saddle, and the slab leans by thousandths to tenths
of a radius to one side or, as likely, to the other (``rest_asymmetry``). Gravity pushes very soft disks out of
their rows (``new_neighbours``); the rest state then depends on the fall and is found by dynamics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.paper.slab_response import (
    SCALARS,
    Event,
    LoadPath,
    Measured,
    Measures,
    events_dataset,
    locate,
    states_picture,
)
from granular_response.scene import Scene
from granular_response.solve import Problem
from granular_response.solve.equilibrium import Rearranged
from granular_response.state import State
from granular_response.store.result import FORCE, LENGTH, common_candidates, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import Progress, map_tasks

FloatArray = NDArray[np.float64]

#: What is kept of the measurements; the others are about friction.
KEPT = tuple(
    name
    for name in SCALARS
    if name not in ("third_peak", "third_peak_prominence", "sliding_contacts", "asymmetry_sign")
)

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

    def scene(self, method: str) -> Scene:
        """With walls twice as stiff as the disks and a unit force."""
        return Scene.from_dict(
            {
                "packing": {"kind": "slab", "layers": self.layers, "disks_per_row": self.disks_per_row},
                "contact": {"normal_stiffness": self.normal_stiffness, "friction": 0.0},
                "wall": {"normal_stiffness": 2.0 * self.normal_stiffness, "friction": 0.0},
                "loads": [{"disk": "top-centre", "force": [0.0, -1.0]}],
                "protocol": {"method": method},
            }
        )


@dataclass(frozen=True)
class Task:
    """A slab with everything asked of it."""

    slab: Slab
    forces: tuple[float, ...]
    method: str
    tolerance: float  #: width of the brackets of events, per force at which they happen
    keep_states: bool


@dataclass(frozen=True)
class Outcome:
    """What a task leaves behind."""

    slab: Slab
    forces: tuple[float, ...]
    measured: Measured
    events: Mapping[str, Event]
    rest_asymmetry: float
    new_neighbours: int
    problem: Problem
    rest: State
    states: tuple[State, ...]  #: at the forces, if they are kept
    regions: NDArray[np.bool_] | None  #: (force, pair) pairs of the region of opened contacts


def solve(task: Task) -> Outcome:
    """Settle a slab, load it step by step, measure it and locate its events."""
    scene = task.slab.scene(task.method)
    path = LoadPath.of(scene, settle(task.slab, task.method))
    states = path.through(task.forces)
    measures = Measures(path)
    happened: dict[str, Callable[[State], bool]] = {
        "first_opening": lambda state: measures.region(state).count > 0,
        "crossover": measures.double_peaked,
        "teardrop_reaches_floor": lambda state: measures.region(state).reaches_floor,
    }
    found = {
        name: locate(name, path, task.forces, happened[name], _width(task, states, happened[name]), text)
        for name, text in EVENTS.items()
    }
    packing = path.problem.packing
    kept = [path.rest, *states] if task.keep_states else [path.rest]
    kept = common_candidates(kept, packing.radius)
    return Outcome(
        slab=task.slab,
        forces=task.forces,
        measured=Measured.of(measures, states),
        events=found,
        rest_asymmetry=rest_asymmetry(packing.position, path.rest, packing.width),
        new_neighbours=new_neighbours(packing.position, path.rest),
        problem=path.problem,
        rest=kept[0],
        states=tuple(kept[1:]),
        regions=np.stack([measures.region(s).contacts for s in states]) if task.keep_states else None,
    )


def settle(slab: Slab, method: str) -> State:
    """The rest state: by dynamics, as the paper has it, where the lattice does not hold."""
    try:
        return rest_state(Problem.from_scene(slab.scene(method)))
    except Rearranged:
        return rest_state(Problem.from_scene(slab.scene("dynamics")))


def _width(task: Task, states: Sequence[State], happened: Callable[[State], bool]) -> float:
    """Width asked of the bracket of an event, from the first force at which it has happened."""
    at = [force for force, state in zip(task.forces, states, strict=True) if happened(state)]
    return task.tolerance * min(at, default=task.forces[-1])


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


def simulate(
    parameters: Mapping[str, Any], *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``response``, ``rest``, ``states``, ``events``, ``sizes``, ``widths`` and ``stiffness``.

    Parameters
    ----------
    parameters
        ``method`` (as ``protocol.method`` of a scene); ``layers``, ``disks_per_row``, ``normal_stiffness``
        and increasing ``forces`` of the slab whose states are kept; ``sizes`` and ``widths``, lists of
        [layers, disks_per_row], each with all of ``size_stiffnesses`` and ``size_forces``; ``stiffnesses`` of
        the first slab, with ``stiffness_forces``; ``compared_stiffnesses``, the two of them that
        ``response_change`` compares (Sec. IV.C); ``tolerance`` and ``size_tolerance``, widths of the brackets
        of events per force at which they happen, of the first slab and of the others.
    workers, progress
        Of ``map_tasks``.

    Raises
    ------
    ValueError
        If a parameter is missing or out of range.
    SweepError
        If a slab cannot be solved.
    """
    values = Parameters(parameters)
    solved = map_tasks(solve, values.tasks(), workers=workers, progress=progress, what="slabs")
    outcomes = {outcome.slab: outcome for outcome in solved}
    main = outcomes[values.main]
    return {
        "response": response(main, values.forces),
        "rest": states_picture([main.rest], main.problem),
        "states": pictures(main, values.forces),
        "events": events_dataset(list(main.events.values())),
        "sizes": table("slab", [outcomes[slab] for slab in values.size_slabs], values.size_forces),
        "widths": table("slab", [outcomes[slab] for slab in values.width_slabs], values.size_forces),
        "stiffness": stiffness_table(
            [outcomes[slab] for slab in values.stiffness_slabs], values.stiffness_forces, values.compared
        ),
    }


def pictures(outcome: Outcome, forces: Sequence[float]) -> xr.Dataset:
    """The states of a slab along ``force``, with the region of opened contacts in each."""
    assert outcome.regions is not None
    data = states_picture(outcome.states, outcome.problem, "force")
    data["teardrop"] = variable(
        ("force", "contact"),
        outcome.regions.astype(np.int8),
        "1 for contacts of the connected region of opened contacts below the load",
    )
    horizontal = network.lattice_direction(outcome.rest) == network.HORIZONTAL
    count = outcome.regions.sum(axis=1)
    data["teardrop_horizontal"] = variable(
        ("force",),
        np.where(count > 0, (outcome.regions & horizontal).sum(axis=1) / np.maximum(count, 1), np.nan),
        "fraction of the region's contacts that are horizontal at rest; nan without a region",
    )
    return data.isel(force=np.searchsorted(outcome.forces, forces))


def stiffness_table(outcomes: Sequence[Outcome], forces: Sequence[float], compared: tuple[float, ...]) -> xr.Dataset:
    """As :func:`table`, and how much the response at x = 0 changes between two stiffnesses (Sec. IV.C)."""
    data = table("normal_stiffness", outcomes, forces)
    soft, stiff = (data["response_at_centre"].sel(normal_stiffness=k).values for k in compared)
    data["response_change"] = variable(
        ("force",),
        soft / stiff - 1.0,
        "relative change of the response at x = 0 from the second to the first of compared_stiffness",
    )
    data["compared_stiffness"] = variable(
        ("compared",), np.array(compared), "normal stiffnesses whose responses are compared"
    )
    return data


def response(outcome: Outcome, forces: Sequence[float]) -> xr.Dataset:
    """Measurements on one slab along ``force``."""
    data = table("slab", [outcome], forces).isel(slab=0)
    data = data.rename(floor_place="floor_disk").drop_vars([f"{name}_bracket" for name in EVENTS])
    return data.assign_coords(
        floor_disk=variable(("floor_disk",), outcome.measured.disks, "index of the floor disk"),
        interior=variable(
            ("floor_disk",), outcome.measured.interior.astype(np.int8), "1 for disks away from the side walls"
        ),
    )


def table(dimension: str, outcomes: Sequence[Outcome], forces: Sequence[float]) -> xr.Dataset:
    """Measurements on slabs along ``dimension`` and ``force``, and the brackets of their events.

    Slabs have different numbers of floor disks: ``floor_response`` and ``x`` run over ``floor_place``, from
    left to right, and are nan beyond the last disk of a slab.
    """
    grid = (dimension, "force")

    def along_grid(values: Callable[[Measured], NDArray]) -> NDArray:
        return np.stack([values(o.measured)[np.searchsorted(o.forces, forces)] for o in outcomes])

    places = max(len(o.measured.x) for o in outcomes)

    def padded(values: FloatArray) -> FloatArray:
        full = np.full((*values.shape[:-1], places), np.nan)
        full[..., : values.shape[-1]] = values
        return full

    data = {name: variable(grid, along_grid(_scalar(name)), SCALARS[name]) for name in KEPT}
    for name, described in outcomes[0].measured.certificates.data_vars.items():
        data[str(name)] = variable(grid, along_grid(_certified(str(name))), described.attrs["long_name"])
    data["floor_response"] = variable(
        (*grid, "floor_place"),
        along_grid(lambda m: padded(m.response)),
        "vertical floor force that the load adds, per applied force",
    )
    for name, text in EVENTS.items():
        brackets = [(o.events[name].low, o.events[name].high) for o in outcomes]
        data[f"{name}_bracket"] = variable(
            (dimension, "bracket"),
            np.array(brackets),
            f"forces {FORCE} between which: {text}; nan if not up to the first",
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
    coordinates = {name: variable((dimension,), np.array(values), text) for name, (values, text) in own.items()}
    coordinates["force"] = variable(("force",), np.array(forces, float), f"applied force {FORCE}")
    coordinates["x"] = variable(
        (dimension, "floor_place"),
        np.stack([padded(o.measured.x) for o in outcomes]),
        f"rest position from the loaded disk {LENGTH}",
    )
    dataset = xr.Dataset(data).assign_coords(coordinates)
    dataset["bracket"] = variable(("bracket",), np.array(["low", "high"]), "ends of a bracket")
    return dataset


def _scalar(name: str) -> Callable[[Measured], NDArray]:
    return lambda part: part.scalars[name]


def _certified(name: str) -> Callable[[Measured], NDArray]:
    return lambda part: part.certificates[name].values


class Parameters:
    """The keys this study reads, checked, and the tasks that they ask for."""

    def __init__(self, given: Mapping[str, Any]) -> None:
        self.given = given
        self.method = str(self._value("method"))
        self.main = Slab(self._whole("layers", 2), self._whole("disks_per_row", 7), self._positive("normal_stiffness"))
        self.forces = self._increasing("forces")
        self.size_forces = self._increasing("size_forces")
        self.stiffness_forces = self._increasing("stiffness_forces")
        self.stiffnesses = self._increasing("stiffnesses")
        self.compared = self._increasing("compared_stiffnesses")
        if len(self.compared) != 2 or not set(self.compared) <= set(self.stiffnesses):
            raise ValueError(f"compared_stiffnesses = {list(self.compared)}: must be two of stiffnesses")
        self.tolerance = self._positive("tolerance")
        self.size_tolerance = self._positive("size_tolerance")
        self.size_stiffnesses = self._increasing("size_stiffnesses")
        self.size_slabs = self._slabs("sizes")
        self.width_slabs = self._slabs("widths")
        self.stiffness_slabs = [
            Slab(self.main.layers, self.main.disks_per_row, stiffness) for stiffness in self.stiffnesses
        ]

    def tasks(self) -> list[Task]:
        """One task for each different slab, the longest first."""
        asked: dict[Slab, set[float]] = {self.main: set(self.forces)}
        for slabs, forces in (
            (self.size_slabs, self.size_forces),
            (self.width_slabs, self.size_forces),
            (self.stiffness_slabs, self.stiffness_forces),
        ):
            for slab in slabs:
                asked.setdefault(slab, set()).update(forces)
        by_cost = sorted(asked, key=lambda s: (-s.layers * s.disks_per_row, s.normal_stiffness))
        return [
            Task(
                slab=slab,
                forces=tuple(sorted(asked[slab])),
                method=self.method,
                tolerance=self.tolerance if slab == self.main else self.size_tolerance,
                keep_states=slab == self.main,
            )
            for slab in by_cost
        ]

    def _value(self, key: str) -> Any:
        if key not in self.given:
            raise ValueError(f"{key} is missing from the parameters of the study 'frictionless_crossover'")
        return self.given[key]

    def _positive(self, key: str) -> float:
        value = self._value(key)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < np.inf:
            raise ValueError(f"{key} = {value!r}: must be a positive number")
        return float(value)

    def _whole(self, key: str, least: int) -> int:
        value = self._value(key)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise ValueError(f"{key} = {value!r}: must be a whole number from {least}")
        return value

    def _increasing(self, key: str) -> tuple[float, ...]:
        value = self._value(key)
        try:
            numbers = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.ndim != 1 or not numbers.size or not (numbers[0] > 0.0 and np.all(np.diff(numbers) > 0.0)):
            raise ValueError(f"{key} = {value!r}: must be a list of positive numbers in increasing order")
        return tuple(float(number) for number in numbers)

    def _slabs(self, key: str) -> list[Slab]:
        value = self._value(key)
        pairs = value if isinstance(value, list | tuple) else []
        if not pairs or not all(
            isinstance(pair, list | tuple)
            and len(pair) == 2
            and all(isinstance(n, int) and not isinstance(n, bool) for n in pair)
            and pair[0] >= 2
            and pair[1] >= 7
            for pair in pairs
        ):
            raise ValueError(f"{key} = {value!r}: must be a list of [layers, disks_per_row], from 2 and 7 on")
        return [Slab(layers, across, stiffness) for stiffness in self.size_stiffnesses for layers, across in pairs]
