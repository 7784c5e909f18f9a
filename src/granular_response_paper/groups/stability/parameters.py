"""Parameters of the stress tests."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from granular_response.scene import Scene, SceneError
from granular_response.scene.base import Count, Description, Finite, Index, NonNegative, Part, Positive, Ratio
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import Integrators, Numbers, Positives, over, some

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


class Drift(Description):
    """Undamped systems."""

    scene: Base
    friction: Ratio
    integrators: Integrators
    part_of_limit: Part = Field(description="Of the limit of velocity Verlet.")
    time: Positive
    friction_time: Positive
    kick: Positive = Field(description="Largest velocity, in mean overlaps times the frequency of a contact.")


class Collisions(Description):
    """One disk that hits the floor or another one."""

    frictions: Positives
    damping_ratios: Annotated[tuple[Ratio, ...], AfterValidator(some)]
    angles: Positives = Field(description="From grazing to head-on, in degrees.")
    spins: Numbers
    time_step: Positive


class Rolling(Description):
    """A disk set on the floor."""

    friction: Positive
    time_step: Positive
    starts: Annotated[tuple[tuple[Finite, Finite], ...], AfterValidator(some)] = Field(description="Velocity and spin.")


class Rounding(Description):
    """Rest states disturbed in their last digits."""

    scene: Base
    displacement: Positive
    kicks: Count
    cases: dict[str, dict[str, Any]] = Field(min_length=1, description="Changes to the scene, by name.")

    @property
    def scenes(self) -> list[Scene]:
        """The scene of each case."""
        return [self.scene.updated(changes) for changes in self.cases.values()]

    @model_validator(mode="after")
    def _check_cases(self) -> Rounding:
        for name, changes in self.cases.items():
            try:
                self.scene.updated(changes)
            except SceneError as error:
                raise Problem(str(error), key=("cases", name), value=changes) from None
        return self


class RandomScenes(Description):
    """Random scenes, each result checked from its positions alone."""

    number: Count
    chunk: Count = Field(description="Scenes of one task.")
    maximum_steps: Count


class Parameters(Description):
    """Section ``stability``."""

    seed: Index = Field(description="Of everything random.")
    time_steps: TimeSteps
    drift: Drift
    collisions: Collisions
    rolling: Rolling
    rounding: Rounding
    random_scenes: RandomScenes
