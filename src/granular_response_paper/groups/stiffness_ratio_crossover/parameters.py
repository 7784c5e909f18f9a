"""Parameters of the response against the ratio of tangential to normal stiffness."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Positive, Ratio
from granular_response_paper.parameters import UNIT_LOAD, Curve, SceneGroup, over


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "contact.stiffness_ratio", "loads")] = UNIT_LOAD
    force: Positive = Field(description="In mean disk weights.")
    ratios: Curve[Ratio] = Field(description="k_T/k_N.")
    tolerance: Positive = Field(description="Width of the brackets of the events, as a ratio.")
