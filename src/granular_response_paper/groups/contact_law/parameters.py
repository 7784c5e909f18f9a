"""Parameters of the comparison of contact laws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response_paper.parameters import UNIT_LOAD, Coefficients, Growing, SceneGroup, over


class Parameters(SceneGroup):
    """Section ``contact_law``."""

    scene: Annotated[Scene, over(UNIT_LOAD, "contact.law", "contact.friction", "loads", "protocol.load_factors")] = (
        Field(description="Base scene; contact.normal_stiffness is that of the linear law.")
    )
    friction: Coefficients = Field(description="Between disks.")
    forces: Growing = Field(description="In mean disk weights.")
