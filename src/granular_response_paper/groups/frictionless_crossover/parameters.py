"""Parameters of the frictionless slabs under a growing force."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Positive, allowed
from granular_response_paper.parameters import UNIT_LOAD, Checks, Growing, Rows, SceneGroup, Some, over

_FRICTIONLESS = UNIT_LOAD.updated({"contact.friction": 0.0})

#: Layers and disks in the lowest row.
Shapes = Some[tuple[Rows, Annotated[int, Field(strict=True, ge=7), allowed("must be a whole number from 7 on")]]]


class Parameters(SceneGroup):
    scene: Annotated[
        Scene, over(_FRICTIONLESS, "contact.friction", "wall.friction", "wall.normal_stiffness", "loads")
    ] = Field(description="The slab whose states are kept; walls are twice as stiff as the disks.")
    forces: Growing = Field(description="On it, in mean disk weights.")
    tolerance: Positive = Field(description="Width of the brackets of its events, per force, at all stiffnesses.")
    sizes: Shapes = Field(description="Slabs of several depths: layers and disks in the lowest row.")
    widths: Shapes = Field(description="Slabs of several widths.")
    size_stiffnesses: Growing = Field(description="Normal stiffnesses of sizes and of widths.")
    size_forces: Growing = Field(description="On them.")
    size_tolerance: Positive = Field(description="Width of the brackets of events of sizes and of widths.")
    region_layers: Count = Field(description="Of the deepest of sizes whose open region is followed closely.")
    region_forces: Growing = Field(description="On these, at which it is.")
    stiffnesses: Growing = Field(description="Normal stiffnesses of the first slab.")
    stiffness_forces: Growing = Field(description="On it at each of them.")

    def checks(self) -> Checks:
        least = min(layers for layers, _ in self.sizes)
        yield "region_layers", self.region_layers >= least, f"must be at least {least}, the fewest layers of sizes"
