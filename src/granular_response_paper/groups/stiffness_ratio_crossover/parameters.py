"""Parameters of the response against the ratio of tangential to normal stiffness."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from granular_response.scene import Scene
from granular_response.scene.base import Positive, Ratio, allowed
from granular_response_paper.parameters import UNIT_LOAD, SceneGroup, growing, over


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "contact.stiffness_ratio", "loads")] = UNIT_LOAD
    force: Positive = Field(description="In mean disk weights.")
    ratios: Annotated[
        tuple[Ratio, ...],
        Field(min_length=2),
        AfterValidator(growing),
        allowed("must be two or more growing numbers from 0 to 1e6"),
    ] = Field(description="k_T/k_N.")
    tolerance: Positive = Field(description="Width of the brackets of the events, as a ratio.")
