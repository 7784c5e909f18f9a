"""Parameters of the response with friction against the force."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Description, NonNegative, Positive, Ratio
from granular_response_paper.parameters import (
    UNIT_LOAD,
    Checks,
    Coefficients,
    EqualRows,
    Growing,
    Loading,
    SceneGroup,
    over,
)

#: Of Figs. 7 to 9.
PROFILE_FRICTIONS = (0.2, 1.0)


class End(Description):
    """Where the path of one friction stops, if below the last of ``forces``."""

    friction: Ratio
    force: Positive


class FrictionAxis(Description):
    """Fig. 12."""

    frictions: Coefficients
    force: Positive
    tolerance: Positive = Field(description="Width of the bracket, as a coefficient of friction.")


class LargeForces(Loading):
    """Fig. 16b: dynamics from rest to each force."""

    ramp_time: NonNegative
    time_step: Positive


class EqualRowsPaths(EqualRows):
    """Load paths of it."""

    frictions: Coefficients
    forces: Growing


class Parameters(SceneGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, "contact.friction", "loads")] = UNIT_LOAD
    frictions: Coefficients = Field(description="Of Fig. 6.")
    forces: Growing = Field(description="Of Fig. 6, in mean disk weights.")
    ends: tuple[End, ...] = ()
    extra_forces: tuple[Loading, ...] = Field((), description="Further ones at one friction.")
    states_of: Coefficients = Field(description="Frictions whose states are stored and whose events are all located.")
    asymmetry: Positive = Field(description="Asymmetry of the response from which symmetry is lost.")
    friction_axis: FrictionAxis
    dynamics: LargeForces
    equal_rows: EqualRowsPaths

    def checks(self) -> Checks:
        every, shown = list(self.frictions), " and ".join(f"{one:g}" for one in PROFILE_FRICTIONS)
        for key, frictions in (("frictions", self.frictions), ("states_of", self.states_of)):
            there = set(PROFILE_FRICTIONS) <= set(frictions)
            yield key, there, f"must have {shown} among them, which Figs. 7 to 9 show"
        yield "dynamics.friction", self.dynamics.friction in every, f"must be one of frictions = {every}"
