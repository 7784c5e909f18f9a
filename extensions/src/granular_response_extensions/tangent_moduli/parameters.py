"""Parameters of the incremental moduli of loaded slabs."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Positive, Ratio
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import UNIT_LOAD, Growing, SceneGroup, over, some

#: The solid has the triangles of a lattice, smooth walls and no rotations.
_DECIDED = "packing.polydispersity", "packing.sides", "contact.friction", "contact.rolling_friction", "wall", "loads"


class Slab(Description):
    """A slab under a growing force."""

    friction: Ratio = Field(description="Between disks.")
    forces: Growing = Field(description="In mean disk weights.")
    shown: Positive = Field(description="The force whose map is drawn, or the next one above it.")


class Parameters(SceneGroup):
    """Section ``tangent_moduli``."""

    scene: Annotated[Scene, over(UNIT_LOAD, *_DECIDED)] = Field(default=UNIT_LOAD, description="A lattice.")
    slabs: Annotated[tuple[Slab, ...], AfterValidator(some)] = Field(description="One for each friction.")
    widths: Growing = Field(description="w of the Gaussian over which fields are averaged, in radii.")
    smoothing: Positive = Field(description="w of the Gaussian under which floor responses are compared, in radii.")
    waves: tuple[Count, Count] = Field(description="Highest half waves of body forces, along x and z.")

    @model_validator(mode="after")
    def _check_rows(self) -> Parameters:
        if self.scene.packing.model_dump()["layers"] < 2:
            raise Problem("must be 2 or more: one row has no triangles", key=("scene", "packing", "layers"), value=1)
        return self
