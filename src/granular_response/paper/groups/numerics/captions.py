"""What the figures of this group show."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import WEIGHT, Caption, of_scene, values

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    return {
        "numerics": Caption(
            "What the paper says about its numerics, measured; dotted, what it says. (a) Error of floor forces and "
            "of the response against the kinetic energy per disk at which a run stops, for µ = "
            f"{values(parameters.frictions)} at {parameters.force:g} {WEIGHT}. (b) Kinetic energy per disk of "
            f"statically finished states under {values(parameters.restart.forces)} {WEIGHT} put back into the "
            f"dynamics, µ = {parameters.friction:g}. (c) Time to rest under gravity against the damping of a contact "
            f"over the critical one, µ = {parameters.friction:g}.",
            "Three plots. (a) Errors that grow with the energy at which a run stops. (b) Kinetic energies far below "
            "the paper's. (c) A time to rest that falls with the damping, past the paper's choice.",
            of_scene(parameters.scene, friction=None),
        )
    }
