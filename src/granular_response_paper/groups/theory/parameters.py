"""Parameters of the predictions without simulation."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from granular_response.scene.base import Description, Positive, Ratio, allowed
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import Positives


def _odd(value: int) -> int:
    if value % 2 == 0:
        raise Problem("")
    return value


class Parameters(Description):
    stiffness_ratio: Ratio = Field(description="k_T/k_N of the isotropic lattice; fixes its Poisson ratio.")
    ray_angle: Annotated[float, Field(strict=True, ge=0.0, lt=90.0), allowed("must be degrees from 0 to below 90")] = (
        Field(description="Angle of the rays to the vertical, in degrees.")
    )
    diffusion_length: Positive = Field(description="Of the rays, in radii.")
    depths: Positives = Field(description="Heights of the slabs for the rays, in radii.")
    half_width: Positive = Field(description="Of the profiles, in slab heights.")
    points: Annotated[
        int, Field(strict=True, ge=3), AfterValidator(_odd), allowed("must be an odd whole number from 3 on")
    ] = Field(description="Points of each profile; odd, so that x = 0 is one.")
