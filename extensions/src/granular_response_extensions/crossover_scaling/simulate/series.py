"""Series of slabs that differ in one quantity, and power laws of it through their events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS, variable
from granular_response_extensions.crossover_scaling.parameters import Parameters, Series, varied
from granular_response_paper.records import axes, column, labels, record, table

#: Layers of the paper's slab, to which a confinement in proportion to the weight refers.
PAPERS_LAYERS = 15


@record
class ScaledSlab:
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

    @property
    def work(self) -> float:
        """Roughly how long it takes."""
        return self.layers**2 * self.disks_per_row * (20.0 if self.friction else 1.0)


def slabs(parameters: Parameters) -> list[tuple[Series, ScaledSlab]]:
    """Series, each with one of its slabs; a slab that is in several series is there as often."""
    found = []
    for one in parameters.series:
        each = product(one.heights, one.disks_per_layer, one.stiffness_per_layer, one.confinement)
        for layers, across, stiffness, constant in each:
            # odd, so that a row has a disk in the middle
            disks = 2 * int(np.ceil((layers * across - 1e-9 - 1.0) / 2.0)) + 1
            force = constant * (layers / PAPERS_LAYERS if one.confined == "as weight" else 1.0)
            slab = ScaledSlab(layers, disks, one.friction, layers * stiffness, force, one.sides == "periodic")
            found.append((one, slab))
    return found


def packings(parameters: Parameters, *, surveyed: bool) -> dict[ScaledSlab, ScaledSlab]:
    """The slabs of the survey, or all others, each once."""
    found = slabs(parameters)
    left = {slab for series, slab in found if slab.layers in series.surveyed}
    return {slab: slab for _, slab in found if (slab in left) == surveyed}


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
