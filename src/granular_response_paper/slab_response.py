"""What the studies of Sec. V store of a slab under a growing force: numbers, events, pictures, as datasets.

The paths, what is measured on them and how events are found: :mod:`granular_response.studies`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from granular_response.observe import network, peaks
from granular_response.observe.widths import half_maximum_width
from granular_response.scene import Packing
from granular_response.scene.lattice import SlabPacking
from granular_response.solvers.problem import Problem
from granular_response.state import State
from granular_response.store.result import certificates_dataset, common_candidates, states_dataset
from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response.studies import EventNotBracketed, Happening, LoadPath, Measures, bisect_event
from granular_response.studies.measures import MARGINS
from granular_response.studies.path import NARROW
from granular_response_paper.records import column, record, table, variables

#: The parts of a state that a picture of its contact network and its response need.
PICTURE = (
    "position", "angle", "contact_disk", "contact_partner", "contact_status", "contact_normal_force",
    "contact_tangential_force", "wall_disk", "wall_index", "wall_status", "wall_normal_force", "load_factor",
)  # fmt: skip


@record
class Scalars:
    """Numbers that are measured on a loaded state."""

    response_at_centre: float = column("floor response below the loaded disk")
    central_dip: float = column(
        "how far the response at x = 0 is below the lower maximum beside it, per largest response"
    )
    peak_count: float = column("number of peaks of the floor response")
    double_peaked: float = column("1 where the floor response has a peak on each side of x = 0 that exceeds it")
    third_peak_prominence: float = column(
        "prominence of a third peak at x = 0 of a double-peaked response, per largest response; 0 without it"
    )
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

    @classmethod
    def of(cls, measures: Measures, state: State) -> Scalars:
        """Measured on a state."""
        m, x, response, region = measures, measures.x, measures.response(state), measures.region(state)
        largest = float(response[m.interior].max())
        return cls(
            response_at_centre=m.centre(state),
            central_dip=m.dip(state),
            peak_count=len(peaks.find_peaks(x, response, interior=m.interior)),
            double_peaked=m.double_peaked(state),
            third_peak_prominence=m.third_peak(state) / largest,
            asymmetry=m.asymmetry(state),
            asymmetry_sign=peaks.asymmetry_sign(x, response),
            peak_height=largest,
            half_maximum_width=half_maximum_width(x, response),
            opened_contacts=m.opened(state),
            sliding_contacts=int(np.count_nonzero(state.pairs.sliding)) if m.friction > 0.0 else 0,
            teardrop_depth=region.depth,
            teardrop_width=region.width,
            reaches_floor=region.reaches_floor,
            network_asymmetry=network.network_asymmetry(state.pairs, m.mirror),
        )


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


def locate(
    path: LoadPath, forces: Sequence[float], asked: Mapping[str, Happening], width: float = NARROW
) -> list[Event]:
    """Where on a path each of what is ``asked`` happens first, by its name; see :meth:`LoadPath.first`."""
    friction = path.scene.contact.friction
    return [Event(name, friction, *path.first(forces, what, width), what.definition) for name, what in asked.items()]


def between(happened: Callable[[float], bool], low: float, high: float, width: float) -> tuple[float, float]:
    """Where something happens first: (0, low) if it has at the lower value, (high, nan) if not at the upper one."""
    try:
        return bisect_event(happened, low, high, width).ends
    except EventNotBracketed:
        return (0.0, low) if happened(low) else (high, float("nan"))


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
    data = table([Scalars.of(measures, state) for state in states], "state")
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
    # without the disks that nothing determines: few states have any, and the states of a grid have the same variables
    certificates = certificates_dataset(states).drop_vars("undetermined", errors="ignore")
    return data.assign(certificates.variables).assign(further).assign_coords(coordinates)


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
