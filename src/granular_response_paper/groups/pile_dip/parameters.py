"""Parameters of the pile under gravity."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import PilePacking, Scene
from granular_response.scene.base import Positive
from granular_response_paper.parameters import Checks, SceneGroup, over

_PILE = Scene(packing=PilePacking(), loads=())


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(_PILE, "loads")] = Field(default=_PILE, description="The pile with friction.")
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    dip_height: Positive = Field(description="Height at which the stress under the apex is compared, in radii.")

    def checks(self) -> Checks:
        packing = self.scene.packing
        yield "scene.packing.layers", packing.model_dump()["layers"] >= 2, "must be 2 or more: one disk has no dip"
        half = 0.5 * packing.build().width  # which has the axis and a place on either side of it
        yield "stress_spacing", self.stress_spacing <= half, f"must be at most {half:g}, half the width of the pile"
