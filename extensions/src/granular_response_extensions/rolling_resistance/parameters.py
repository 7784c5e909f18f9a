"""Parameters of what rolling resistance changes."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import PilePacking, Scene
from granular_response.scene.base import NonNegative, Positive
from granular_response_paper.parameters import UNIT_LOAD, Checks, Coefficients, Rows, SceneGroup, Some, over

_ROLLING = ("contact.rolling_friction", "wall.rolling_friction")
_PILE = Scene(packing=PilePacking(), loads=())


class Parameters(SceneGroup):
    pile: Annotated[Scene, over(_PILE, "packing", "loads", "preparation", *_ROLLING)] = Field(
        description="The pile with support."
    )
    layers: Some[Rows] = Field(description="Of the piles.")
    rolling_frictions: Coefficients = Field(description="Of piles; at the floor the same.")
    ramps: Some[NonNegative] = Field(description="Times over which gravity grows, in sqrt(R/g); 0: at once.")
    least_friction: Positive = Field(description="From which on piles are tried, floor and disks alike.")
    most_friction: Positive = Field(description="Up to which they are.")
    tolerance: Positive = Field(description="Width of the bracket of the least friction that holds a pile.")
    moved: Positive = Field(description="A pile holds if no disk moves farther on its way to rest, in radii.")
    scene: Annotated[Scene, over(UNIT_LOAD, "contact.friction", "loads", *_ROLLING)] = Field(description="The slab.")
    slab_frictions: Coefficients = Field(description="Between disks of slabs.")
    slab_rolling_frictions: Coefficients = Field(description="Of disks in slabs.")
    slab_forces: tuple[Positive, Positive] = Field(description="A small and a large one.")
    torques: tuple[Positive, Positive] = Field(
        description="On the loaded disk, counter-clockwise, in mean disk weights times the mean radius: a small and a "
        "large one."
    )
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")

    def checks(self) -> Checks:
        least = self.least_friction
        yield "most_friction", self.most_friction > least, f"must be above least_friction = {least:g}"
