"""Starts of disordered packings side by side: what touches at rest, and the dip under one force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from granular_response.scene.lattice import touching_largest
from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper.groups.phase_diagram.parameters import Parameters
from granular_response_paper.records import column, record, stacked, table, variables
from granular_response_paper.survey.crossover import CONFIDENCE, LEVELS, Ensemble, shapes_of_samples, weights
from granular_response_paper.survey.datasets import PREPARED

#: Coordinates of a case.
CASE = (*PREPARED, "realizations")
CONTACTS = ("horizontal_contacts", "oblique_contacts")
_BOOTSTRAPPED = "quantiles of the bootstrapped mean"


@record
class Start:
    """What touches at rest in the packings of one start, and under which force the response is compared."""

    case: int
    step: int  #: of the force
    applied_force: float = column(f"applied force {WEIGHTS}")
    distance: float = column(f"distance of neighbours before gravity acts {RADII}")
    contacts: float = column("mean number of contacts of a disk at rest, walls counted")
    contacts_interval: FloatArray = column(_BOOTSTRAPPED, "level")
    missing_horizontal: float = column("horizontal part of the contacts that the lattice has and the packing has not")
    missing_horizontal_interval: FloatArray = column(_BOOTSTRAPPED, "level")


def starts_of(source: xr.Dataset, packings: xr.Dataset, asked: Parameters) -> list[Start]:
    """Every start of a polydispersity under the force at which they are compared.

    Raises ValueError if the first case is not the lattice, or no case has one of the polydispersities and its force.
    """
    if source["polydispersity"].values[0] > 0.0:
        raise ValueError(f"blocks = {list(asked.blocks)}: must begin with one of the lattice")
    found: list[Start] = []
    lattice, constant = packings.isel(case=0, realization=0), packings["lattice_constant"].values
    for one in asked.compared:
        alike = np.isclose(source["polydispersity"].values, one.polydispersity) & (source["gravity_ramp"].values == "")
        places = np.argwhere(alike[:, None] & np.isclose(source["force"].values, one.force)).tolist()
        if not places:
            had = f"polydispersity {one.polydispersity:g} and a force of {one.force:g}"
            raise ValueError(f"compared: no case of blocks = {list(asked.blocks)} has {had}")
        for case, step in places:
            usual = constant[case] == constant[0]
            distance = touching_largest(one.polydispersity) if usual else float(constant[case])
            packing = packings.isel(case=case, realization=slice(0, int(packings["realizations"].values[case])))
            horizontal, oblique = (float(lattice[kind].values) - packing[kind].values for kind in CONTACTS)
            contacts, part = packing["coordination_number_with_walls"].values, horizontal / (horizontal + oblique)
            drawn = weights(len(part), asked.draws, asked.seed)
            ends = [np.quantile(drawn @ values / len(values), LEVELS) for values in (contacts, part)]
            found.append(Start(case, step, one.force, distance, contacts.mean(), ends[0], part.mean(), ends[1]))
    return found


def dips_of_few(symmetric: Ensemble, step: int, asked: Parameters) -> FloatArray:
    """(level, 3) shapes of means of the largest of ``numbers`` realizations: quantiles, and the ends of their 95 %."""
    shapes = shapes_of_samples(symmetric, step, max(asked.numbers), seed=asked.seed)
    ends = np.quantile(np.quantile(shapes, LEVELS, axis=1), CONFIDENCE, axis=1).T
    return np.column_stack([np.quantile(shapes, LEVELS), ends])


def side_by_side(
    found: Sequence[Start], few: Mapping[tuple[int, int], FloatArray], shapes: xr.Dataset, number: int
) -> xr.Dataset:
    """The starts with their dips; ``few`` (width, start) are those of means of a ``number`` of realizations."""
    case, step = (xr.DataArray([getattr(one, name) for one in found], dims="case") for name in ("case", "step"))
    dips = shapes.isel(case=case, step=step).rename(shape="dip", shape_interval="dip_interval")
    own = {name: dips[name].variable for name in ("dip", "dip_interval")} | dict(table(found, "case").variables)
    text = f"quantiles of the shape of the means of {number} realizations, drawn at random"
    every, of_ends = stacked(few), "ends of 95 % of these quantiles over draws of the realizations"
    further = variables(
        dip_of_means=("width case level", every[..., 0], text),
        dip_of_means_interval=("width case level end", every[..., 1:], of_ends),
    )
    return xr.Dataset(own, {name: dips[name].variable for name in (*CASE, "width", "level")}).assign(further)
