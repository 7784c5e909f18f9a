"""Parameters of the study of time steps."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Index, NonNegative
from granular_response_paper.parameters import Integrators, Positives, over, some

#: What becomes of a kick, and in words.
SETTLES, CYCLES, BLOWS_UP, NO_REST = 0, 1, 2, 3
OUTCOMES = ("settles", "cycles", "blows up", "no rest state")

#: Scenes of trials start from the default one; which method a trial takes is its own matter.
Base = Annotated[Scene, over(Scene())]

Axis = Literal[
    "normal_stiffness", "stiffness_ratio", "damping_ratio", "friction", "wall_friction", "wall_stiffness",
    "polydispersity", "load",
]  # fmt: skip


class TimeSteps(Description):
    """Raw dynamics of a kicked slab at rest, without a guard on the step."""

    scene: Base
    integrators: Integrators
    steps: Count
    ratios: Positives = Field(description="Time step over the predicted limit.")
    axes: dict[Axis, Annotated[tuple[NonNegative, ...], AfterValidator(some)]]


class Parameters(Description):
    seed: Index = Field(description="Of everything random.")
    time_steps: TimeSteps
