"""Parameters of the predictions without simulation."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene.base import Count, Description, Positive, Ratio
from granular_response_paper.parameters import Odd, Positives


class Parameters(Description):
    stiffness_ratio: Ratio = Field(description="k_T/k_N of the isotropic lattice; fixes its Poisson ratio.")
    ray_angle: float = Field(strict=True, ge=0.0, lt=90.0, description="Angle of the rays to the vertical, in degrees.")
    diffusion_length: Positive = Field(description="Of the rays, in radii.")
    depths: Positives = Field(description="Heights of the slabs for the rays, in radii.")
    half_width: Positive = Field(description="Of the profiles, in slab heights.")
    points: Annotated[Count, Odd] = Field(description="Points of each profile, of which x = 0 is one.")
