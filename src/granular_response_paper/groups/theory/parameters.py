"""Parameters of the predictions without simulation."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene.base import Positive, Ratio, allowed
from granular_response_paper.parameters import Checked, Checks, Positives

_ODD = "must be an odd whole number from 3 on"


class Parameters(Checked):
    stiffness_ratio: Ratio = Field(description="k_T/k_N of the isotropic lattice; fixes its Poisson ratio.")
    ray_angle: Annotated[float, Field(strict=True, ge=0.0, lt=90.0), allowed("must be degrees from 0 to below 90")] = (
        Field(description="Angle of the rays to the vertical, in degrees.")
    )
    diffusion_length: Positive = Field(description="Of the rays, in radii.")
    depths: Positives = Field(description="Heights of the slabs for the rays, in radii.")
    half_width: Positive = Field(description="Of the profiles, in slab heights.")
    points: Annotated[int, Field(strict=True, ge=3), allowed(_ODD)] = Field(
        description="Points of each profile; odd, so that x = 0 is one."
    )

    def checks(self) -> Checks:
        yield "points", self.points % 2 == 1, _ODD
