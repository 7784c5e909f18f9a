"""Parameters of loading and unloading."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Part, Positive
from granular_response_extensions.parameters import Material, SurveyedGroup
from granular_response_paper.parameters import UNIT_LOAD, Checks, Growing, Some, over

#: Keys of the scenes that cases decide.
OF_CASES = ("packing.polydispersity", "packing.realization", "contact.friction", "loads")


class CycledMaterial(Material):
    """Packings under a load that turns."""

    realizations: Count = Field(1, description="One is all there are of a lattice.")
    surveyed: Annotated[int, Field(strict=True, ge=0)] = Field(
        0, description="Further realizations, that the survey simulates."
    )
    forces: Growing = Field(description="At which the load turns, in mean disk weights; the first one counts as small.")
    increments: Count = Field(description="States from each of these forces to the next one.")


class Parameters(SurveyedGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, *OF_CASES)] = Field(description="Base scene of the lattices.")
    disordered: Annotated[Scene, over(UNIT_LOAD, *OF_CASES)] = Field(description="Base scene of all others.")
    cases: Some[CycledMaterial] = Field(description="Materials.")
    left: Part = Field(
        description="A loop is reversible if it leaves no floor force changed by more than this part of the largest "
        "change under the load."
    )
    width: Positive = Field(description="w of the Gaussian at x = 0 under disordered packings, in radii.")
    tolerance: Part = Field(description="Width of the bracket of the reversible range, as a part of the force.")

    @property
    def surveyed(self) -> bool:
        return any(case.surveyed for case in self.cases)

    def checks(self) -> Checks:
        yield from super().checks()
        materials = {(case.polydispersity, case.friction) for case in self.cases}
        yield "cases", len(materials) == len(self.cases), "must have each material once"

    def of(self, case: CycledMaterial, realization: int) -> Scene:
        """The scene of one packing."""
        base = self.disordered if case.polydispersity else self.scene
        return base.updated(
            {
                "protocol.method": self.method,
                "packing.polydispersity": case.polydispersity,
                "packing.realization": realization,
                "contact.friction": case.friction,
            }
        )
