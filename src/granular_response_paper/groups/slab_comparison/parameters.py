"""Parameters of the comparison with the elastic slab."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Positive, Ratio
from granular_response.theory.slab import Floor
from granular_response_paper.parameters import SIZE, UNIT_LOAD, Checked, Checks, Rows, SceneGroup, Some, over


class DepthSeries(Checked):
    """One material and shape, at several depths."""

    friction: Ratio = Field(description="Between disks.")
    floor: Floor = Field(description="rough: as much friction on floor and walls as between disks.")
    gravity: Literal["at-once", "slow"] = Field(description="How gravity is applied.")
    disks_per_layer: Rows = Field(description="Disks of a row over number of rows.")
    layers: Some[Rows] = Field(description="Numbers of rows.")

    def checks(self) -> Checks:
        holds = self.floor == "smooth" or self.friction > 0.0
        yield "floor", holds, "must be smooth, or rough with friction above 0"


class Parameters(SceneGroup):
    scene: Annotated[
        Scene, over(UNIT_LOAD, *SIZE, "contact.friction", "wall.friction", "preparation.gravity", "loads")
    ] = Field(description="Base scene; contact.stiffness_ratio is that of packings with friction.")
    force: Positive = Field(description="Small, in mean disk weights.")
    cases: Some[DepthSeries] = Field(description="Materials and shapes.")

    def checks(self) -> Checks:
        yield "scene.contact.stiffness_ratio", self.scene.contact.stiffness_ratio > 0.0, "must be above 0"
