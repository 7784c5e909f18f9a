"""Parameters of the pile under gravity."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import PilePacking, Scene
from granular_response.scene.base import Positive
from granular_response_paper.parameters import SceneGroup, over

_PILE = Scene(packing=PilePacking(), loads=())


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(_PILE, "loads")] = Field(default=_PILE, description="The pile with friction.")
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    dip_height: Positive = Field(description="Height at which the stress under the apex is compared, in radii.")
