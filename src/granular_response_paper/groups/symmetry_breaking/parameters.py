"""Parameters of the loss of symmetry."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Description, Index, NonNegative, Positive
from granular_response_paper.parameters import UNIT_LOAD, EqualRows, Growing, SceneGroup, Some, over


class LoadRamp(Description):
    """How a force is applied, and the forces between which the response loses its symmetry."""

    ramp_time: NonNegative
    time_steps: Some[Positive]
    between: tuple[NonNegative, Positive]

    def scene(self, base: Scene, time_step: float) -> Scene:
        """``base`` under this protocol with one of its time steps."""
        changes = {"method": "dynamics", "ramp_time": self.ramp_time, "time_step": time_step}
        return base.updated({f"protocol.{key}": value for key, value in changes.items()})


class Copies(Description):
    """Copies of the packing that differ in the order of arithmetic or by small displacements."""

    force: Positive
    displacement: Positive
    seed: Index


class DisplacedEquilibria(Description):
    """Equilibria that are displaced a little under constant force."""

    forces: Growing
    displacement: Positive


class EqualRowsBracket(EqualRows):
    """The forces between which symmetry is lost there."""

    between: tuple[NonNegative, Positive]


class Parameters(SceneGroup):
    """Section ``symmetry_breaking``; ``method`` is that of the path of ``held``, all else is dynamics."""

    scene: Annotated[Scene, over(UNIT_LOAD, "loads", "protocol.ramp_time", "protocol.time_step")] = UNIT_LOAD
    asymmetry: Positive = Field(description="Above which symmetry counts as lost.")
    tolerance: Positive = Field(description="Width of the brackets, in mean disk weights.")
    protocols: Some[LoadRamp] = Field(description="Ramps and steps to try.")
    equal_rows: EqualRowsBracket
    copies: Copies
    held: DisplacedEquilibria
