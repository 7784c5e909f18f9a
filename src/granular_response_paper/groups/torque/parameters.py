"""Parameters of the force together with a torque."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from granular_response.scene import Scene
from granular_response.scene.base import Finite, NonNegative, Positive, allowed
from granular_response_paper.parameters import UNIT_LOAD, Checks, Numbers, SceneGroup, growing, over


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "loads")] = UNIT_LOAD
    force: Positive = Field(description="In mean disk weights.")
    angle: Finite = Field(description="Of the force below the horizontal, to the right, in degrees.")
    torques: Numbers = Field(description="Clockwise, in mean disk weights times the mean radius.")
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    distances: Annotated[
        tuple[NonNegative, ...],
        Field(min_length=2),
        AfterValidator(growing),
        allowed("must be two or more growing numbers from 0 on"),
    ] = Field(description="Edges of the rings around the load in which changes are summed, in radii.")

    def checks(self) -> Checks:
        yield "torques", self.torques[0] == 0.0, "must be a list of numbers that begins with 0"
