"""Parameters of the readings that are varied one at a time."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Positive
from granular_response_paper.parameters import Coefficients, over


class Parameters(Description):
    """Section ``sensitivity``; all by dynamics but the variant that is not."""

    scene: Annotated[Scene, over(Scene(), "contact.friction", "loads")] = Scene()
    friction: Coefficients = Field(description="Between disks; one dataset for each.")
    force: Positive = Field(description="In mean disk weights.")
    literal_steps: Count = Field(description="Time steps after which friction laws without statics are looked at.")
