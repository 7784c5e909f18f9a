"""Parameters of two forces at once."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from granular_response.scene import Scene
from granular_response.scene.base import Count, Positive, allowed
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import Counts, SceneGroup, growing, over

_UNLOADED = Scene(loads=())

Paths = Annotated[
    tuple[Positive, ...],
    Field(min_length=2),
    AfterValidator(growing),
    allowed("must be two or more growing numbers above 0"),
]


class Parameters(SceneGroup):
    """Section ``superposition``."""

    scene: Annotated[Scene, over(_UNLOADED, "packing.realization", "loads")] = _UNLOADED
    realizations: Count = Field(description="Of the radii.")
    pair_realizations: Count = Field(description="Those of them with two loads.")
    offsets: Counts = Field(description="Places of the loads to either side of the middle of the top row.")
    forces: Paths = Field(description="Each of two loads, in mean disk weights.")
    single_forces: Paths = Field(description="The load on the middle disk.")
    width: Positive = Field(description="w of the Gaussian at x = 0, in radii.")
    tolerance: Positive = Field(description="Change that ends the linear range.")

    @model_validator(mode="after")
    def _check(self) -> Parameters:
        if self.pair_realizations > self.realizations:
            rule = f"must be from 1 to realizations = {self.realizations}"
            raise Problem(rule, key=("pair_realizations",), value=self.pair_realizations)
        farthest = (int(self.scene.packing.build().row_count[-1]) - 1) // 2
        if max(self.offsets) > farthest:
            raise Problem(f"must be places from 1 to {farthest}", key=("offsets",), value=list(self.offsets))
        return self
