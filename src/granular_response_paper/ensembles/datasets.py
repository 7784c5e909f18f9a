"""Realizations as labelled datasets: the responses of every one, and what is counted on packings at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granular_response.store.result import FORCE, LENGTH, flags, variable
from granular_response_paper.ensembles import NOT_REACHED, OUTCOMES, realizations
from granular_response_paper.groups.polydisperse_averages.parameters import Case


def _case_coordinates(cases: Sequence[Case]) -> dict[str, xr.Variable]:
    lattice = [str(case.lattice_constant) for case in cases]
    return {
        "polydispersity": variable("case", [c.polydispersity for c in cases], "delta: spread of the radii"),
        "friction": variable("case", [c.friction for c in cases], "coefficient of friction, walls included"),
        "lattice_constant": variable(
            "case", lattice, f"distance of neighbours before gravity acts {LENGTH}, or how it is chosen"
        ),
        "realizations": variable("case", [c.realizations for c in cases], "number of packings"),
    }


def ensembles_dataset(cases: Sequence[Case], found: Sequence[realizations.Realization]) -> xr.Dataset:
    """Every realization of every case; what a case does not have is nan, or NOT_REACHED."""
    most = max(case.realizations for case in cases)
    steps = max(len(case.forces) for case in cases)
    slots = max(one.x.size for one in found)
    shape = (len(cases), most, steps)
    force = np.full((len(cases), steps), np.nan)
    x = np.full((len(cases), most, slots), np.nan)
    rest_force = np.full_like(x, np.nan)
    response = np.full((*shape, slots), np.nan)
    outcome = np.full(shape, NOT_REACHED, np.int8)
    loaded = {name: np.full(shape, np.nan) for name in realizations.LOADED}
    message = np.full((len(cases), most), "", dtype=object)
    left = iter(found)
    for c, case in enumerate(cases):
        k = len(case.forces)
        force[c, :k] = case.forces
        for r in range(case.realizations):
            one = next(left)
            x[c, r, : one.x.size], rest_force[c, r, : one.x.size] = one.x, one.rest_force
            response[c, r, :k, : one.x.size] = one.response
            outcome[c, r, :k] = one.outcome
            message[c, r] = one.message
            for name in realizations.LOADED:
                loaded[name][c, r, :k] = one.loaded[name]
    dims = ("case", "realization", "step")
    data = {
        "force": variable(("case", "step"), force, f"applied force {FORCE}"),
        "x": variable(
            ("case", "realization", "slot"), x, f"rest position of a floor disk from the loaded disk {LENGTH}"
        ),
        "floor_force_rest": variable(
            ("case", "realization", "slot"), rest_force, f"vertical floor force at rest {FORCE}"
        ),
        "floor_response": variable(
            (*dims, "slot"), response, "vertical floor force that the load adds, per applied force"
        ),
        "outcome": variable(dims, outcome, "what became of the realization", **flags(OUTCOMES)),
        "message": variable(("case", "realization"), message.astype(str), "why a realization failed"),
        **{name: variable(dims, loaded[name], text) for name, text in realizations.LOADED.items()},
    }
    return xr.Dataset(data, coords=_case_coordinates(cases))


def packings_dataset(cases: Sequence[Case], found: Sequence[realizations.Realization]) -> xr.Dataset:
    shape = (len(cases), max(case.realizations for case in cases))
    numbers = {name: np.full(shape, np.nan) for name in realizations.PACKING}
    density = np.full((*shape, realizations.ANGLE_BINS), np.nan)
    left = iter(found)
    for c, case in enumerate(cases):
        for r in range(case.realizations):
            one = next(left)
            density[c, r] = one.angle_density
            for name in realizations.PACKING:
                numbers[name][c, r] = one.packing[name]
    dims = ("case", "realization")
    angle = np.pi / realizations.ANGLE_BINS * np.arange(realizations.ANGLE_BINS)
    return xr.Dataset(
        {
            **{name: variable(dims, numbers[name], text) for name, text in realizations.PACKING.items()},
            "contact_angle_density": variable(
                (*dims, "angle"), density, "distribution of the directions of contacts at rest, per radian"
            ),
        },
        coords={
            "angle": variable("angle", angle, "angle of a contact with the horizontal, in radians"),
            **_case_coordinates(cases),
        },
    )
