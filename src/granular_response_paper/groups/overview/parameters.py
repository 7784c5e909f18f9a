"""Parameters of the overview."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Positive
from granular_response_paper.parameters import UNIT_LOAD, Coefficients, Curve, SceneGroup, over


class Parameters(SceneGroup):
    scene: Annotated[
        Scene, over(UNIT_LOAD, "packing.polydispersity", "packing.lattice_constant", "contact.friction", "loads")
    ] = Field(description="Base scene; the walls are those of the ordered slabs.")
    frictions: Coefficients
    forces: Curve[Positive] = Field(
        description="In mean disk weights: frames; the first and the last are in the picture."
    )
