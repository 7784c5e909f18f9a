"""Parameters of the forces and the stress inside a slab."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Description, Positive
from granular_response_paper.parameters import UNIT_LOAD, Checks, Coefficients, Positives, SceneGroup, over


class Profiles(Description):
    """Fig. 15."""

    frictions: Coefficients = Field(description="Among the others.")
    force: Positive = Field(description="In mean disk weights, by dynamics from rest.")
    rows: Positives = Field(description="Below the loaded disk; half-integers are between rows.")


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "contact.friction", "wall.friction", "loads")] = UNIT_LOAD
    frictions: Coefficients = Field(description="Of the walls too.")
    force: Positive = Field(description="In mean disk weights.")
    stress_width: Positive = Field(description="w of the Gaussian, in radii.")
    stress_spacing: Positive = Field(description="Of the grid, in radii.")
    stress_half_width: Positive = Field(description="Of the grid, in radii.")
    profiles: Profiles

    def checks(self) -> Checks:
        every, spacing = list(self.frictions), self.stress_spacing
        yield "profiles.frictions", set(self.profiles.frictions) <= set(every), f"must be among frictions = {every}"
        yield "stress_half_width", self.stress_half_width >= spacing, f"must be at least stress_spacing = {spacing:g}"
