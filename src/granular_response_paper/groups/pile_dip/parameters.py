"""Parameters of the pile under gravity."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from granular_response.scene import PilePacking, Scene
from granular_response.scene.base import Positive
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import SceneGroup, over

_PILE = Scene(packing=PilePacking(), loads=())


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(_PILE, "loads")] = Field(default=_PILE, description="The pile with friction.")
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    dip_height: Positive = Field(description="Height at which the stress under the apex is compared, in radii.")

    @model_validator(mode="after")
    def _check_sizes(self) -> Parameters:
        if self.scene.packing.model_dump()["layers"] < 2:
            raise Problem("must be 2 or more: one disk has no dip", key=("scene", "packing", "layers"), value=1)
        half = 0.5 * self.scene.packing.build().width
        if self.stress_spacing > half:  # the axis and a place on either side of it
            rule = f"must be at most {half:g}, half the width of the pile"
            raise Problem(rule, key=("stress_spacing",), value=self.stress_spacing)
        return self
