"""Realizations as labelled datasets: the responses of every one, and what is counted on packings at rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from granular_response.store.variables import RADII, WEIGHTS, variable
from granular_response_paper.ensembles import NOT_REACHED
from granular_response_paper.ensembles.parameters import Case
from granular_response_paper.ensembles.realizations import ANGLE_BINS, Realization
from granular_response_paper.records import axes, stacked, table, variables

#: A case and a realization of it.
Place = tuple[int, int]

ALONG = ("case", "realization")


def places(cases: Sequence[Case]) -> list[Place]:
    """Those of all realizations of all cases."""
    return [(c, r) for c, case in enumerate(cases) for r in range(case.realizations)]


def _case_coordinates(cases: Sequence[Case]) -> dict[str, xr.Variable]:
    starts = [str(case.lattice_constant) for case in cases]
    return variables(
        polydispersity=("case", [case.polydispersity for case in cases], "delta: spread of the radii"),
        friction=("case", [case.friction for case in cases], "coefficient of friction, walls included"),
        lattice_constant=("case", starts, f"distance of neighbours before gravity acts {RADII}, or how it is chosen"),
        realizations=("case", [case.realizations for case in cases], "number of packings"),
    )


def ensembles_dataset(cases: Sequence[Case], found: Mapping[Place, Realization]) -> xr.Dataset:
    """Every realization of every case; what a case does not have is nan, or NOT_REACHED."""
    data = table(found, *ALONG)
    outcome = np.nan_to_num(data["outcome"].values, nan=NOT_REACHED).astype(np.int8)
    force = stacked({(c,): case.forces for c, case in enumerate(cases)}, float)
    return xr.Dataset(
        {"force": variable(("case", "step"), force, f"applied force {WEIGHTS}")}
        | dict(data.assign(outcome=data["outcome"].copy(data=outcome)).variables)
        | dict(table({place: one.loaded for place, one in found.items()}, *ALONG).variables)
    ).assign_coords(_case_coordinates(cases))


def packings_dataset(cases: Sequence[Case], found: Mapping[Place, Realization]) -> xr.Dataset:
    """What is counted on every packing at rest; nan for what a case does not have."""
    angle = np.pi / ANGLE_BINS * np.arange(ANGLE_BINS)
    return (
        table({place: one.packing for place, one in found.items()}, *ALONG)
        .assign_coords(axes(angle=(angle, "angle of a contact with the horizontal, in radians")))
        .assign_coords(_case_coordinates(cases))
    )
