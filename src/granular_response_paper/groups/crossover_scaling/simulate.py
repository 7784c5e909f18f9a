"""How the crossover from one peak to two depends on the size of a slab (Secs. IV.B and VIII), with friction too.

The paper calls the crossover a finite-size effect: gravity presses contacts together, a force opens them, and the
deeper a slab the more force it takes. What scales here is said apart. The *series* are slabs that differ in one
quantity: the number of layers, the width over the depth, the stiffness, or the *confinement*, the force that horizontal
contacts bear at rest. On a lattice with periodic sides gravity gives them none: all distances in a row are those of the
period, so the confinement is chosen, by a lattice constant a little below two radii. In series of layers the stiffness
grows with the layers, so that gravity makes the same overlaps at every depth, and the confinement is constant, as
between the paper's walls, or grows with the weight as well.

Forces grow by one factor until the response has two peaks and the region of open contacts has reached the floor; events
are then those of the path, or narrowed between two of them. Without friction every state is a minimum of the energy,
and what happens is narrowed by bisection.

The deepest slabs are simulated by the survey (:mod:`granular_response_paper.survey.simulate`), as the others are.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.scene import Scene
from granular_response.state import FloatArray, State
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response_paper import slab_response
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.crossover_scaling.parameters import Parameters, Series, varied
from granular_response_paper.records import axes, column, columns, labels, record, table
from granular_response_paper.slab_response import Happening, LoadPath, Measures, Scalars, by_motion
from granular_response_paper.survey.packings import measured

#: Layers of the paper's slab, to which a confinement in proportion to the weight refers.
PAPERS_LAYERS = 15

#: Force over the confinement, from which the answers of contacts to small forces are taken.
SMALL = 0.1

EVENTS = {
    "first_opening": slab_response.FIRST_OPENING,
    "crossover": "the floor response at x = 0 is visibly below both maxima beside it",
    "two_peaks": slab_response.TWO_PEAKS,
    "reaches_floor": slab_response.REACHES_FLOOR,
}


@record
class Slab:
    """One slab; series share what they have in common."""

    layers: int = column("number of rows of the slab")
    disks_per_row: int = column("disks in the bottom row")
    friction: float = column("coefficient of friction between disks")
    normal_stiffness: float = column("normal stiffness of contacts in mean weights per mean radius")
    #: of no meaning between walls
    asked_confinement: float = column(f"force of horizontal contacts that is asked for {WEIGHTS}")
    periodic: bool = column("1 for periodic sides, 0 for walls")

    def scene(self, base: Scene) -> Scene:
        """``base`` with this slab; between walls disks just touch, as in the paper."""
        packing: dict[str, int | float | str] = {"layers": self.layers, "disks_per_row": self.disks_per_row}
        if self.periodic:
            packing |= {"sides": "periodic", "lattice_constant": 2.0 - self.asked_confinement / self.normal_stiffness}
        contact = {"friction": self.friction, "normal_stiffness": self.normal_stiffness}
        return base.updated({"packing": packing, "contact": contact})


@record
class Outcome:
    """What a task leaves behind; arrays along its forces."""

    confinement: float = column(f"mean force of horizontal contacts in the central third at rest {WEIGHTS}")
    linear_opening: float = column(
        f"force {WEIGHTS} at which the first contact would open if contacts went on as under a small one"
    )
    #: nan above for what was not seen
    brackets: FloatArray = column(f"forces {WEIGHTS} between which: {'; '.join(EVENTS.values())}", "event", "bracket")
    by_motion: float = column(
        "steps of the force in which the motion of the disks had a part; nan: not recorded", later=True
    )
    force: FloatArray = column(f"applied force {WEIGHTS}", "line")
    dip: FloatArray = column(columns(Scalars)["central_dip"].long_name, "line")
    depth: FloatArray = column(f"depth of the region of opened contacts below the loaded disk {RADII}", "line")
    width: FloatArray = column(f"largest width of the region of opened contacts {RADII}", "line")
    opened: FloatArray = column("contacts of the region", "line")


def compute(
    scene: Scene, visible: float, first_force: float, factor: float, most_forces: int, tolerance: float
) -> Outcome:
    """The path of one slab; the parameters are those of the group.

    Raises what ``rest_state`` and load paths raise.
    """
    path = LoadPath.of(scene)
    measures = Measures(path)
    confinement = horizontal_force(measures)

    asked = [  # in the order of EVENTS
        slab_response.first_opening(measures),
        Happening(lambda state: measures.dip(state) > visible, EVENTS["crossover"]),
        Happening(measures.double_peaked, slab_response.TWO_PEAKS),
        slab_response.reaches_floor(measures),
    ]
    forces: list[float] = []
    left = asked
    while left and len(forces) < most_forces:
        forces.append(confinement * first_force * factor ** len(forces))
        state = path.at(forces[-1])
        left = [what for what in left if not what.happened(state)]
    states = path.through(forces)
    width = slab_response.NARROW if scene.contact.friction else tolerance
    brackets = np.array([path.first(forces, what, width) for what in asked])
    regions = [measures.region(state) for state in states]
    return Outcome(
        confinement,
        linear_opening(measures, path.at(SMALL * confinement)),
        brackets,
        float(sum(map(by_motion, states))),
        np.array(forces),
        np.array(list(map(measures.dip, states))),
        *np.array([(one.depth, one.width, one.count) for one in regions], float).T,
    )


def horizontal_force(measures: Measures) -> float:
    """Mean normal force at rest of the horizontal contacts of disks in the central third (mean disk weights)."""
    rest = measures.rest
    chosen = (network.lattice_direction(rest) == network.HORIZONTAL) & measures.near
    return float(rest.pairs.normal_force[chosen].mean())


def linear_opening(measures: Measures, small: State) -> float:
    """Force at which the first contact in the central third would open if all forces went on as up to ``small``.

    Exact in a slab without friction, where all contacts go on as they are until then, but for the overlaps' effect on
    directions.
    """
    rest = measures.rest.pairs.normal_force
    change = (small.pairs.normal_force - rest) / abs(small.load_factor)
    falling = measures.near & measures.rest.pairs.touching & (change < 0.0)
    return float((rest[falling] / -change[falling]).min())


@dataclass(frozen=True)
class Power:
    """A power law through brackets of positive numbers.

    Least squares of the middles of the brackets' logarithms. Intervals are ranges: over the fits of all points and
    of all but the smallest, and over every place that the events may have in their brackets.
    """

    at: FloatArray  #: (k,) what is varied
    low: FloatArray  #: (k,)
    high: FloatArray  #: (k,) nan where the event was not seen

    @cached_property
    def usable(self) -> NDArray[np.intp]:
        """Points with both ends."""
        return np.flatnonzero((self.low > 0.0) & np.isfinite(self.high))

    def exponent(self) -> FloatArray:
        """(value, least, largest); nan with less than two points."""
        return self._range(_slope)

    def at_size(self, size: float, continuum: float | None = None) -> FloatArray:
        """(value, least, largest) of the law at ``size``.

        With the power of the ``continuum``, that power from the last point on is one more reading of the interval.
        """
        found = np.exp(self._range(lambda x: 1.0 / len(x) + (np.log(size) - x.mean()) * _slope(x)))
        if continuum is not None and len(self.usable):
            last = self.usable[-1]
            grown = float((size / self.at[last]) ** continuum)
            found[1] = min(found[1], self.low[last] * grown)
            found[2] = max(found[2], self.high[last] * grown)
        return found

    def _range(self, weights: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Of a sum over the logarithms with ``weights`` (k,) of the logarithms of what is varied."""
        values, ends = [], []
        for points in (self.usable, self.usable[1:]):
            if len(points) < 2:
                continue
            least, most = np.log(self.low[points]), np.log(self.high[points])
            each = weights(np.log(self.at[points]))
            blur = float(np.abs(each) @ (0.5 * (most - least)))
            values.append(float(each @ (0.5 * (least + most))))
            ends += [values[-1] - blur, values[-1] + blur]
        return np.array([values[0], min(ends), max(ends)]) if values else np.full(3, np.nan)


def _slope(x: FloatArray) -> FloatArray:
    """(k,) weights of the ordinates in the slope of a line through points at ``x`` (k,), by least squares."""
    return np.asarray((x - x.mean()) / ((x - x.mean()) ** 2).sum())


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``slabs`` (slab), ``paths`` (slab, step) and ``powers`` (series).

    Raises SweepError if a slab cannot be solved.
    """
    done = measured(parameters, "slabs", packings, task, Outcome, work=_work)
    datasets = slab_and_path_tables(slabs(parameters), done, packings(parameters, surveyed=True))
    datasets["slabs"].attrs.update(visible=parameters.visible, tolerance=parameters.tolerance)
    return labelled(datasets | {"powers": power_table(datasets["slabs"], parameters)}, parameters.base)


def slabs(parameters: Parameters) -> list[tuple[str, Slab]]:
    """Names of series, each with one of its slabs; a slab that is in several series is there as often."""
    found = []
    for one in parameters.series:
        each = product(one.heights, one.disks_per_layer, one.stiffness_per_layer, one.confinement)
        for layers, across, stiffness, constant in each:
            disks, periodic = _odd(layers * across), one.sides == "periodic"
            confinement = constant * (layers / PAPERS_LAYERS if one.confined == "as weight" else 1.0)
            found.append((one.name, Slab(layers, disks, one.friction, layers * stiffness, confinement, periodic)))
    return found


def packings(parameters: Parameters, *, surveyed: bool) -> dict[Slab, Slab]:
    """The slabs of the survey, or all others, each once."""
    deep = {series.name: series.surveyed for series in parameters.series}
    found = slabs(parameters)
    left = {slab for name, slab in found if slab.layers in deep[name]}
    return {slab: slab for _, slab in found if (slab in left) == surveyed}


def _odd(number: float) -> int:
    """The next odd whole number, so that a row has a disk in the middle."""
    return 2 * int(np.ceil((number - 1e-9 - 1.0) / 2.0)) + 1


def _work(slab: Slab) -> float:
    """Roughly how long a slab takes."""
    return slab.layers**2 * slab.disks_per_row * (20.0 if slab.friction else 1.0)


def task(asked: Parameters, slab: Slab) -> partial[Outcome]:
    """One of these slabs."""
    given = asked.visible, asked.first_force, asked.factor, asked.most_forces, asked.tolerance
    return partial(compute, slab.scene(asked.base), *given)


def slab_and_path_tables(
    found: Sequence[tuple[str, Slab]], done: Mapping[Slab, Outcome], stored: Collection[Slab]
) -> dict[str, xr.Dataset]:
    """``slabs``: what each is, and its events; ``paths``: what is measured at its forces, nan beyond its last one."""
    each = [slab for _, slab in found]
    of, data = table(each, "slab"), table([done[slab] for slab in each], "slab")
    brackets = {}
    for k, (name, event) in enumerate(EVENTS.items()):
        text = f"forces {WEIGHTS} between which: {event}; nan if not up to the first"
        brackets[f"{name}_bracket"] = variable(("slab", "bracket"), data["brackets"].values[:, k], text)
    kept = of[["layers", "disks_per_row", "friction", "normal_stiffness"]].variables
    coordinates = {
        "series": variable("slab", [name for name, _ in found], "series"),
        "periodic": of["periodic"].variable.astype(int),
        "surveyed": variable("slab", [int(slab in stored) for slab in each], "1 for slabs of the survey"),
        **axes(bracket=(["low", "high"], "ends of a bracket")),
    }
    slabs = xr.Dataset(brackets).assign(data[["linear_opening", "confinement", "by_motion"]].variables)
    paths = data[["force", "dip", "depth", "width", "opened"]].rename_dims(line="step")
    return {"slabs": slabs.assign_coords(kept).assign_coords(coordinates), "paths": paths}


_RANGE = "range over the fits with and without the smallest, and over the brackets"


@record
class Fitted:
    """The power law of an event in a series."""

    exponent: FloatArray = column(f"power of what is varied with which the event's force grows; {_RANGE}", "end")
    extrapolated: FloatArray = column(
        f"force {WEIGHTS} of the event by this power law; {_RANGE}, "
        "and the largest slab with the power of the continuum",
        "end",
    )


def power_table(slabs: xr.Dataset, parameters: Parameters) -> xr.Dataset:
    """Powers of what each series varies, and where its events are at ``extrapolated`` layers."""
    ends, events = ("value", "least", "largest"), ("first_opening", "crossover", "reaches_floor")
    found = {}
    for s, series in enumerate(parameters.series):
        one = slabs.isel(slab=np.flatnonzero(slabs["series"].values == series.name))
        for e, event in enumerate(events):
            law = Power(varied(one, series.varied), *one[f"{event}_bracket"].values.T)
            far = np.full(len(ends), np.nan)
            if series.varied == "layers":
                far = law.at_size(parameters.extrapolated, continuum(series) if event != "first_opening" else None)
            found[s, e] = Fitted(law.exponent(), far)
    confined = ["walls" if one.sides == "walls" else one.confined for one in parameters.series]
    coordinates = {
        "series": variable("series", [one.name for one in parameters.series], "series"),
        **labels(
            "series", parameters.series, friction="coefficient of friction", varied="what differs along the series"
        ),
        "confined": variable("series", confined, "what sets the force of horizontal contacts at rest"),
        **axes(event=(events, "event"), end=(ends, "value and ends of the interval")),
    }
    data = table(found, "series", "event").assign_coords(coordinates)
    return data.assign_attrs(layers=parameters.extrapolated)


def continuum(series: Series) -> float | None:
    """Power of the layers of what happens at the scale of the whole slab, where disks are small.

    Equal slabs of any size are one slab where all that stands against a force grows with the layers squared: weights,
    and a confinement that grows as they do. Without friction it is the confinement alone, a stress, on a length. With
    friction and a constant confinement there are two scales, and no such power: None.
    """
    if series.confined == "as weight" and series.sides == "periodic":
        return 2.0
    return 1.0 if series.friction == 0.0 else None
