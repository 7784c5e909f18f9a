"""Parameters of the force together with a torque."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Finite, NonNegative, Positive
from granular_response_paper.parameters import UNIT_LOAD, Curve, SceneGroup, over, refused_unless

_FROM_NONE = refused_unless(lambda torques: torques[:1] == (0.0,), "must begin with 0, from which changes are counted")


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "loads")] = UNIT_LOAD
    force: Positive = Field(description="In mean disk weights.")
    angle: Finite = Field(description="Of the force below the horizontal, to the right, in degrees.")
    torques: Annotated[tuple[Finite, ...], _FROM_NONE] = Field(
        description="Clockwise, in mean disk weights times the mean radius."
    )
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    distances: Curve[NonNegative] = Field(
        description="Edges of the rings around the load in which changes are summed, in radii."
    )
