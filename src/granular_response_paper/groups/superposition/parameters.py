"""Parameters of two forces at once."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Positive
from granular_response_paper.parameters import Checks, Counts, Curve, SceneGroup, over

_UNLOADED = Scene(loads=())

#: Forces of the two figures.
FORCES = {"fig23_superposition": 0.2, "fig24_superposition": 1.0}


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(_UNLOADED, "packing.realization", "loads")] = _UNLOADED
    realizations: Count = Field(description="Of the radii.")
    offsets: Counts = Field(description="Places of the loads to either side of the middle of the top row.")
    forces: Curve[Positive] = Field(description="Each of two loads, in mean disk weights.")
    single_forces: Curve[Positive] = Field(description="The load on the middle disk.")
    width: Positive = Field(description="w of the Gaussian at x = 0, in radii.")
    tolerance: Positive = Field(description="Change that ends the linear range.")

    def checks(self) -> Checks:
        shown = " and ".join(f"{force:g}" for force in FORCES.values())
        there = set(FORCES.values()) <= set(self.forces)
        yield "forces", there, f"must have {shown} among them, which the figures show"
        farthest = (int(self.scene.packing.build().row_count[-1]) - 1) // 2
        yield "offsets", max(self.offsets) <= farthest, f"must be places from 1 to {farthest}"
