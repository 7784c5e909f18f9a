"""Parameters of the influence of every disk on the floor."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Positive
from granular_response_extensions.parameters import Material
from granular_response_paper.parameters import MATERIAL, UNIT_LOAD, Checks, Counts, Positives, SceneGroup, Some, over


class Packings(Material):
    """Packings of one material, whose walls rub as the disks."""

    realizations: Count = Field(1, description="One is all there are of a lattice.")


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, *MATERIAL, "loads")] = Field(description="Base scene.")
    cases: Some[Packings] = Field(description="Materials.")
    separations: Counts = Field(description="Of the two halves of a load from its disk, in places of the row.")
    margin: Positive = Field(description="From the side walls, within which no load is looked at, in radii.")
    fitted: Positives = Field(description="Least and largest height over distance of the halves that are fitted.")

    def checks(self) -> Checks:
        yield "fitted", len(self.fitted) == 2 and self.fitted[0] < self.fitted[1], "must be two growing numbers"
        half = 0.5 * self.scene.packing.build().width
        yield "margin", self.margin < half, f"must be below {half:g}, half the width of the slab"
