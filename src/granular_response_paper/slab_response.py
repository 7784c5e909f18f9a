"""A slab under a growing force on one disk: its states along the force, what is measured on them, and events.

What the studies of Sec. V share. Forces are in mean disk weights, lengths in mean radii.

A path goes from one contact event to the next. What the contacts alone decide (a first opening) changes at one of
them, whose force is exact. What the forces decide (two peaks) changes between two of them, where states are smooth in
the force, and is looked for in that piece alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import events, network, peaks
from granular_response.observe.floor import floor_disks, floor_response, interior_mask, smoothed_response
from granular_response.observe.teardrop import OpenRegion, teardrop
from granular_response.observe.widths import last_passage
from granular_response.scene import Packing, Scene
from granular_response.scene.lattice import TOUCHING_LARGEST, SlabPacking
from granular_response.solvers.path import follow
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import loaded_states
from granular_response.state import OPEN, STICKING, FloatArray, State
from granular_response.state import Event as PathEvent
from granular_response.store.result import certificates_dataset, common_candidates, states_dataset
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.sweeps.rest import rest_state
from granular_response_paper.records import column, record, table, variables

#: A contact is mobilised when its tangential force is within one of these fractions of the Coulomb limit.
#: Whether it slides is lost in the last vibrations before rest, which take it off the limit by a little.
MARGINS = (0.01, 0.05)

#: The linear range ends where the response at x = 0 differs by this fraction from that to the smallest force.
LINEARITY = 0.01

#: What counts as an event.
FIRST_OPENING = "a contact of disks in the central third of the slab is open that touches at rest"
ANY_OPENING = "a contact of disks anywhere in the slab is open that touches at rest"
TWO_PEAKS = "on each side of x = 0 the floor response has a peak that exceeds the response at x = 0"
REACHES_FLOOR = "the region of opened contacts below the load contains a contact of the bottom row"

#: What a path leaves of the force of an event, as a part of it.
EXACT = 1e-8

#: Width of the bracket of what changes between two events, as a part of the force.
NARROW = 1e-6

#: The parts of a state that a picture of its contact network and its response need.
PICTURE = (
    "position", "angle", "contact_disk", "contact_partner", "contact_status", "contact_normal_force",
    "contact_tangential_force", "wall_disk", "wall_index", "wall_status", "wall_normal_force", "load_factor",
)  # fmt: skip


def wall_margin(width: float) -> float:
    """Distance from the side walls within which no peak is looked for: ten radii, less in a narrow slab."""
    return min(10.0, 0.2 * width)


@dataclass
class LoadPath:
    """States of one scene under a growing load, each found from the one below it.

    With dynamics as the protocol (``method: dynamics``) every state starts at rest instead, as in the paper.
    A path stops (``solvers.path.Collapsed``) where the load has pushed its disk below ``lowest``.
    """

    scene: Scene  #: with one load, of unit force
    problem: Problem  #: with the loaded disk chosen
    rest: State
    known: dict[float, State] = field(default_factory=dict)  #: by force
    lowest: float = -np.inf
    method: str = ""

    @classmethod
    def of(cls, scene: Scene, rest: State | None = None, packing: Packing | None = None) -> LoadPath:
        """The path of ``scene``, or of ``packing`` in place of its own, settled under gravity unless ``rest`` is given.

        Raises what ``rest_state`` raises.
        """
        problem = Problem.from_scene(scene, packing)
        rest = rest_state(problem) if rest is None else rest
        return cls(scene, problem.with_loads(rest.position), rest)

    def at(self, force: float) -> State:
        """The state under ``force``."""
        return self.through([force])[0]

    def through(self, forces: Iterable[float]) -> list[State]:
        """States at increasing ``forces``, each computed once. Raises what ``loaded_states`` and ``follow`` raise."""
        forces = [float(force) for force in forces]
        wanted = [force for force in forces if force not in self.known]
        self.method = self.problem.plan.load.method
        literal = self.method == "dynamics"
        while wanted:
            below = max((f for f in self.known if f < wanted[0] and not literal), default=0.0)
            above = min((f for f in self.known if f > wanted[0]), default=np.inf)
            run = [force for force in wanted if force < above]
            start = self.known[below] if below else self.rest
            if self.method == "path":
                states = follow(self.problem, start, run, lowest=self.lowest)
            else:
                states = loaded_states(self.problem, start, run)[1]
            self.known.update(zip(run, states, strict=True))
            wanted = wanted[len(run) :]
        return [self.known[force] for force in forces]

    def first(self, forces: Sequence[float], happening: Happening, width: float = NARROW) -> tuple[float, float]:
        """Where something happens first: after the one force and not after the other.

        ``forces`` are neighbours on the path, with known states. The first of them at which it has happened is narrowed
        to the event of the path between it and the one before, or to ``width`` (per force) within a piece
        between two events; see :class:`Event` for the ends.
        """
        low, high = first_change(forces, [happening.happened(self.known[force]) for force in forces])
        if not np.isfinite(high):
            return low, high
        passed = self.known[high].reached.events
        if happening.of_contacts:
            at = self._change(self.known.get(low, self.rest), passed, happening)
            if at is not None:
                within = max(EXACT * at, self.known[high].reached.events_within or 0.0)
                return max(at - within, low), min(at * (1.0 + EXACT), high)
        ends = [low]
        for force in sorted({end for event in passed for end in (event.load_factor, event.until)}):
            if ends[-1] + width * high < force < high - width * high:
                ends.append(force)
        ends.append(high)
        while len(ends) > 2:
            middle = 1 if happening.in_turn else len(ends) // 2
            ends = ends[: middle + 1] if happening.happened(self.at(ends[middle])) else ends[middle:]
        low, high = ends
        if gone := lost([self.known[high]]):  # and no equilibrium from there on
            before = gone[0].load_factor - width * high
            if before <= low or not happening.happened(self.at(before)):
                return max(before, low), high
            high = before
        if high - low > width * high:
            found = events.bisect_event(
                lambda force: happening.happened(self.at(force)), low, high, width * high, at_low=False, at_high=True
            )
            low, high = found.low, found.high
        return low, high

    def _change(self, state: State, passed: Iterable[PathEvent], happening: Happening) -> float | None:
        """The force of the event by which the contacts of ``state`` come to what has happened; None if by no event."""
        pairs = state.pairs
        place = {pair: k for k, pair in enumerate(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True))}
        for event in passed:
            k = None if event.at_wall else place.get((event.first, event.second))
            if k is None or event.kind not in ("opens", "closes"):
                continue
            status = pairs.status.copy()
            status[k] = OPEN if event.kind == "opens" else STICKING
            pairs = replace(pairs, status=status)
            if happening.happened(replace(state, pairs=pairs)):
                return event.load_factor
        return None


@dataclass(frozen=True)
class Happening:
    """Something that happens along a load path."""

    happened: Callable[[State], bool]
    definition: str
    of_contacts: bool = False  #: whether which disks touch decides it
    #: Whether the events between two forces are looked at in turn, not by halves: a symmetric state that has lost its
    #: stability is left where a path ends, not where it only passes.
    in_turn: bool = False


@record
class Scalars:
    """Numbers that are measured on a loaded state."""

    response_at_centre: float = column("floor response below the loaded disk")
    central_dip: float = column(
        "how far the response at x = 0 is below the lower maximum beside it, per largest response"
    )
    peak_count: float = column("number of peaks of the floor response")
    double_peaked: float = column("1 where the floor response has a peak on each side of x = 0 that exceeds it")
    third_peak: float = column("1 where a double-peaked response has a further peak at x = 0")
    third_peak_prominence: float = column("prominence of that third peak, per largest response; 0 without it")
    asymmetry: float = column("largest difference of the response and its mirror image, per largest response")
    asymmetry_sign: float = column("1 if the part of the response at x > 0 is the larger one, -1 if that at x < 0 is")
    peak_height: float = column("largest floor response")
    half_maximum_width: float = column(f"full width at half maximum of the floor response {RADII}")
    opened_contacts: float = column("contacts of disks in the central third that touch at rest and not under load")
    sliding_contacts: float = column("contacts of disks at the Coulomb limit")
    teardrop_depth: float = column(f"depth of the region of opened contacts below the loaded disk {RADII}")
    teardrop_width: float = column(f"largest width of the region of opened contacts {RADII}")
    reaches_floor: float = column("1 where the region of opened contacts reaches the bottom row")
    network_asymmetry: float = column("fraction of the contacts of disks without a mirror image")


class Measures:
    """What is measured on the loaded states of one slab."""

    def __init__(self, path: LoadPath):
        packing = path.problem.packing
        self.rest, self.width = path.rest, packing.width
        self.friction = path.scene.contact.friction
        self.loaded_disk = int(path.problem.load_disk[0])
        self.lattice_constant = float(packing.lattice_constant or 2.0)
        self.disks = floor_disks([path.rest], np.flatnonzero(packing.row == 0))
        middle = float(path.rest.position[self.loaded_disk, 0])
        self.x: FloatArray = path.rest.position[self.disks, 0] - middle
        self.interior = interior_mask(self.x, packing.width, wall_margin(packing.width), left_wall=-middle)
        # Near the load means the central third, as in Figs. 4, 8 and 9. Towards the upper corners some contacts
        # carry almost nothing under gravity, so that they open under the least force.
        self.near = network.interior_contacts(path.rest, packing.width, packing.width / 3.0)
        self._lattice, self._radius = packing.position, packing.radius

    @property
    def confinement(self) -> float:
        """Mean normal force at rest of the horizontal contacts in the central third that touch; 0 where none does."""
        pairs = self.rest.pairs
        level = pairs.touching & (network.lattice_direction(self.rest) == network.HORIZONTAL) & self.near
        return float(pairs.normal_force[level].mean()) if level.any() else 0.0

    @cached_property
    def mirror(self) -> NDArray[np.intp]:
        """(n,) mirror images in the middle, on the undeformed lattice; rows between periodic sides have none."""
        return network.mirror_disks(self._lattice, 0.5 * self.width)

    def response(self, state: State) -> FloatArray:
        """(floor_disk,) floor response per applied force."""
        return floor_response(self.rest, state, self.disks, abs(state.load_factor))

    def centre(self, state: State, width: float = 0.0) -> float:
        """Response at x = 0; that of a disordered packing is smoothed, with a Gaussian of ``width``."""
        if width:
            return float(smoothed_response([0.0], self.x, self.response(state), width)[0])
        return float(np.interp(0.0, self.x, self.response(state)))

    def dip(self, state: State) -> float:
        """How far the response at x = 0 is below the lower maximum beside it, per largest response."""
        return peaks.central_dip(self.x, self.response(state), interior=self.interior)

    def opened(self, state: State, anywhere: bool = False) -> int:
        """Number of contacts of disks that the load opened in the central third, or ``anywhere`` in the slab."""
        rest, state, near = self._matched(state)
        return int(np.count_nonzero(network.contact_changes(rest.pairs, state.pairs).opened & (near | anywhere)))

    def double_peaked(self, state: State) -> bool:
        """Whether the response has two peaks in the sense of the paper's crossover."""
        return peaks.is_double_peaked(self.x, self.response(state), interior=self.interior)

    def third_peak(self, state: State) -> float:
        """Prominence of the further peak of a double-peaked response at x = 0; 0 without it."""
        return peaks.third_peak(self.x, self.response(state), interior=self.interior)

    def asymmetry(self, state: State) -> float:
        """Largest difference of the response and its mirror image, per largest response."""
        return peaks.asymmetry(self.x, self.response(state), interior=self.interior)

    def region(self, state: State) -> OpenRegion:
        """The opened contacts below the load."""
        rest, state, near = self._matched(state)
        return teardrop(rest, state, self.loaded_disk, start=near, lattice_constant=self.lattice_constant)

    def _matched(self, state: State) -> tuple[State, State, NDArray[np.bool_]]:
        """The rest state and this one on one list of candidates, which dynamics may have made anew, and those near."""
        if self.rest.pairs.same_candidates(state.pairs) and self.rest.walls.same_candidates(state.walls):
            return self.rest, state, self.near
        rest, state = common_candidates([self.rest, state], self._radius)
        return rest, state, network.interior_contacts(rest, self.width, self.width / 3.0)

    def mobilised(self, state: State) -> list[int]:
        """Number of contacts of disks within each of ``MARGINS`` of the Coulomb limit."""
        return [int(state.pairs.near_limit(self.friction, margin).sum()) for margin in MARGINS]

    def scalars(self, state: State) -> Scalars:
        """Every number that is measured."""
        x, response, region, third = self.x, self.response(state), self.region(state), self.third_peak(state)
        largest = float(response[self.interior].max())
        return Scalars(
            response_at_centre=self.centre(state),
            central_dip=self.dip(state),
            peak_count=peaks.peak_count(x, response, interior=self.interior),
            double_peaked=self.double_peaked(state),
            third_peak=third > 0.0,
            third_peak_prominence=third / largest,
            asymmetry=self.asymmetry(state),
            asymmetry_sign=asymmetry_sign(x, response),
            peak_height=largest,
            half_maximum_width=half_maximum_width(x, response),
            opened_contacts=self.opened(state),
            sliding_contacts=network.sliding_count(state, walls=False) if self.friction > 0.0 else 0,
            teardrop_depth=region.depth,
            teardrop_width=region.width,
            reaches_floor=region.reaches_floor,
            network_asymmetry=network.network_asymmetry(state.pairs, self.mirror),
        )


def asymmetry_sign(x: FloatArray, response: FloatArray) -> int:
    """On which side of x = 0 the response is larger: 1 right, -1 left, 0 if neither."""
    return int(np.sign(response[x > 1e-6].sum() - response[x < -1e-6].sum()))


def half_maximum_width(x: FloatArray, response: FloatArray) -> float:
    """Distance of the outermost places where the response passes half of its maximum.

    Linear between samples; nan where a side does not fall to half. Peaks that reach half count as one.
    """
    half = 0.5 * float(response.max())
    return last_passage(x, response, half) + last_passage(-x[::-1], response[::-1], half)


@record
class Event:
    """Where along an axis something happens for the first time: above ``low`` and not above ``high``.

    ``high`` is nan if it does not happen up to ``low``, the end of the axis; ``low`` is 0 if it has happened
    at the first value of the axis already.
    """

    name: str = column("what happens")
    friction: float = column("coefficient of friction, nan if it is the axis")
    low: float = column(f"value before the event: force {WEIGHTS}, or coefficient of friction")
    high: float = column("value at which it has happened; nan if not up to the lower one")
    definition: str = column("what counts as the event")


def first_change(values: Sequence[float] | FloatArray, happened: Iterable[bool]) -> tuple[float, float]:
    """The last of ``values`` before the first True and its own; see :class:`Event` for the ends."""
    k = next((k for k, yes in enumerate(happened) if yes), None)
    if k is None:
        return float(values[-1]), np.nan
    return float(values[k - 1]) if k else 0.0, float(values[k])


def linear_end(force: FloatArray, response: FloatArray, tolerance: float) -> tuple[float, float]:
    """Forces (k,) between which ``response`` (k,) is first off its first value by more than ``tolerance`` of it.

    The latter is nan if it never is. Responses may be nan from some force on.
    """
    known = np.isfinite(response)
    if not known.any():
        return np.nan, np.nan
    return first_change(force[known], np.abs(response[known] / response[0] - 1.0) > tolerance)


def locate(
    path: LoadPath, forces: Sequence[float], asked: Mapping[str, Happening], width: float = NARROW
) -> list[Event]:
    """Where on a path each of what is ``asked`` happens first, by its name; see :meth:`LoadPath.first`."""
    friction = path.scene.contact.friction
    return [Event(name, friction, *path.first(forces, what, width), what.definition) for name, what in asked.items()]


def first_opening(measures: Measures, anywhere: bool = False) -> Happening:
    """The first contact opens, in the central third of the slab or ``anywhere`` in it."""
    text = ANY_OPENING if anywhere else FIRST_OPENING
    return Happening(lambda state: measures.opened(state, anywhere) > 0, text, of_contacts=True)


def reaches_floor(measures: Measures) -> Happening:
    """The open contacts reach the floor."""
    return Happening(lambda state: measures.region(state).reaches_floor, REACHES_FLOOR, of_contacts=True)


def two_peaks(measures: Measures) -> Happening:
    """The response has two peaks: the crossover."""
    return Happening(measures.double_peaked, TWO_PEAKS)


def happenings(measures: Measures, smallest: State, asymmetry: float) -> dict[str, Happening]:
    """What is looked for along a load path, by name.

    ``smallest`` is the state under the smallest force; ``asymmetry`` is that from which symmetry is lost.
    """
    linear, force = measures.centre(smallest), abs(smallest.load_factor)
    off = f"the response at x = 0 differs by more than {LINEARITY:.0%} from that at force {force:g}"
    third = "the double-peaked floor response has a further peak at x = 0"
    exceeds = f"along the load path, the asymmetry of the floor response exceeds {asymmetry:g}"
    return {
        "first_opening": first_opening(measures),
        "linear_range": Happening(lambda state: abs(measures.centre(state) / linear - 1.0) > LINEARITY, off),
        "crossover": two_peaks(measures),
        "reaches_floor": reaches_floor(measures),
        "third_peak": Happening(lambda state: measures.third_peak(state) > 0.0, third),
        "loss_of_symmetry_path": Happening(lambda state: measures.asymmetry(state) > asymmetry, exceeds, in_turn=True),
    }


def lost(states: Iterable[State]) -> list[PathEvent]:
    """Equilibria that a path through ``states``, in turn, has lost on its way."""
    return [event for state in states for event in state.reached.events if event.lost]


def by_motion(state: State) -> bool:
    """Whether the motion of the disks had a part in what led from the state before to this one."""
    return state.reached.method == "dynamics" or any(event.kind != "stepped over" for event in lost([state]))


@record
class Lost:
    """An equilibrium that a path has lost."""

    friction: float = column("coefficient of friction of the path")
    kind: str = column("how the path goes on")
    start: float = column(f"force at which the equilibrium ends {WEIGHTS}")
    until: float = column(f"force at which the path goes on {WEIGHTS}")
    displacement: float = column(f"largest of a disk on the way {RADII}")

    @classmethod
    def of(cls, friction: float, event: PathEvent) -> Lost:
        """As a path with this coefficient of friction records it."""
        return cls(friction, event.kind, event.load_factor, event.until, event.displacement)


def events_dataset(found: Sequence[Event]) -> xr.Dataset:
    """Events as a table along ``event``."""
    return table(found, "event", kind=Event)


def states_picture(
    states: Sequence[State], problem: Problem, dimension: str = "state", of: Sequence[str] | None = PICTURE
) -> xr.Dataset:
    """What pictures of the contact network need of ``states``: the variables ``of`` them or, for None, all."""
    packing = problem.packing
    dataset = states_dataset(common_candidates(states, packing.radius), dimension)
    dataset = dataset[list(of)] if of else dataset
    dataset["axis"].attrs.update(long_name="axis labels", units="1")
    return dataset.assign(
        variables(
            force=(dimension, [abs(state.load_factor) for state in states], f"applied force {WEIGHTS}"),
            radius=("disk", packing.radius, f"disk radius {RADII}"),
            width=("", packing.width, f"distance of the side walls {RADII}"),
            loaded_disk=("", int(problem.load_disk[0]), "index of the loaded disk"),
        )
    )


def measured(measures: Measures, states: Sequence[State]) -> xr.Dataset:
    """Everything measured on loaded states of one material, along ``state``."""
    data = table([measures.scalars(state) for state in states], "state")
    response = np.stack([measures.response(state) for state in states])
    mobilised = np.array([measures.mobilised(state) for state in states], dtype=float)
    near = "contacts of disks whose tangential force is within a fraction of the Coulomb limit"
    further = variables(
        floor_response=("state floor_disk", response, "vertical floor force that the load adds, per applied force"),
        mobilised_contacts=("state margin", mobilised, near),
    )
    coordinates = variables(
        floor_disk=("floor_disk", measures.disks, "index of the floor disk"),
        x=("floor_disk", measures.x, f"rest position from the loaded disk {RADII}"),
        interior=("floor_disk", measures.interior.astype(np.int8), "1 for disks away from the side walls"),
        margin=("margin", MARGINS, "fraction below the Coulomb limit"),
    )
    return data.assign(certificates_dataset(states).variables).assign(further).assign_coords(coordinates)


def measured_dataset(dims: tuple[str, ...], parts: Sequence[tuple[Any, xr.Dataset]], shape: tuple) -> xr.Dataset:
    """Measurements on a grid of ``dims``; nan where there are none.

    ``parts`` are pairs of an index into the whole grid, as numpy takes it, and what was :func:`measured` there, on
    slabs with the same floor disks.
    """
    data = {}
    for name, values in parts[0][1].items():
        grid = np.full((*shape, *values.shape[1:]), np.nan)
        for index, one in parts:
            grid[index] = one[name].values
        data[name] = variable((*dims, *values.dims[1:]), grid, values.attrs["long_name"])
    return xr.Dataset(data).assign_coords(parts[0][1].coords)


def measured_along(dimension: str, measured: Sequence[xr.Dataset]) -> xr.Dataset:
    """Measurements one after the other, along ``dimension``."""
    ends = np.cumsum([0, *(one.sizes["state"] for one in measured)]).tolist()
    parts = [(slice(*place), one) for place, one in zip(pairwise(ends), measured, strict=True)]
    return measured_dataset((dimension,), parts, (ends[-1],))


def equal_rows(layers: int, disks: int) -> Packing:
    """An ordered packing between walls with as many ``disks`` in every row, each second one shifted by a radius.

    The paper has "15 layers of 60 particles each", which rows that alternate between 61 and 60 disks do not have.
    """
    packing = SlabPacking(layers=layers, disks_per_row=disks, sides="periodic").build()
    return replace(packing, width=packing.width + 1.0, periodic=False)


def disordered(stop_kinetic_energy: float) -> dict[str, float | str]:
    """Changes to a scene whose disks differ in size: the largest ones touch at first, and how their fall is solved."""
    return {
        "packing.lattice_constant": TOUCHING_LARGEST,
        "protocol.integrator": "leapfrog",
        "protocol.time_step": "auto",
        "protocol.stop_kinetic_energy": stop_kinetic_energy,
    }
