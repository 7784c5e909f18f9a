"""Parameters of the experiments that Sec. II.B reviews."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field

from granular_response.scene import Load, PouredPacking, Scene, SlabPacking
from granular_response.scene.base import Count, Description, Index, Positive
from granular_response.state import FloatArray
from granular_response_paper.parameters import UNIT_LOAD, Checks, SceneGroup, Some, over

AnyPacking = Annotated[SlabPacking | PouredPacking, Field(discriminator="kind")]
Ends = tuple[Positive, Positive]

#: Direction of the lattice below the horizontal, in degrees.
LATTICE = 60.0


class LoadedPacking(Description):
    """One packing under one load."""

    packing: str = Field(description="A name among the packings.")
    force: Positive = Field(description="In mean disk weights.")
    angle: float = Field(90.0, ge=10.0, le=170.0, description="Of the force below the horizontal, in degrees.")
    realizations: Count

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector of the force."""
        return float(np.cos(np.radians(self.angle))), -float(np.sin(np.radians(self.angle)))


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "packing", "loads")] = Field(description="Material and preparation.")
    packings: dict[str, AnyPacking]
    cases: Some[LoadedPacking]
    largest_move: Positive = Field(description="Of the loaded disk, beyond which a packing does not hold the force.")
    depths: Count = Field(description="Lines below the load, a mean radius apart.")
    reach: Count = Field(description="Of profiles, to both sides of the load, in radii.")
    width: Positive = Field(description="w of the Gaussian along the lines, in radii.")
    fitted: Ends = Field(description="Depths of the widths: from, in radii, and to, per height of the load.")
    ring: Ends = Field(description="Depths between which directions are looked at, in radii.")
    draws: Count = Field(description="Of the bootstrap.")
    seed: Index = Field(description="Of the draws.")
    pictures: tuple[Index, ...] = Field(description="Cases of which the first packing that holds is drawn.")

    def checks(self) -> Checks:
        for k, case in enumerate(self.cases):
            known = case.packing in self.packings
            yield f"cases.{k}.packing", known, f"must be one of packings ({', '.join(self.packings)})"
        below = max(self.pictures, default=0) < len(self.cases)
        yield "pictures", below, f"must be below {len(self.cases)}"

    @property
    def x(self) -> FloatArray:
        """Places of profiles from the load, half a radius apart."""
        return np.arange(-self.reach, self.reach + 0.5, 0.5)

    def scene_of(self, case: LoadedPacking, realization: int) -> Scene:
        """One realization, with a load of one disk weight."""
        packing = self.packings[case.packing].model_copy(update={"realization": realization})
        whole: dict[str, Any] = dict(self.base) | {"packing": packing}
        return Scene(**whole | {"loads": (Load(disk="top-centre", force=case.direction),)})
