"""Parameters that several groups share."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Description, Fraction, Ratio
from granular_response_paper.parameters import Checks, Path, SceneGroup


class Material(Description):
    """What packings of a case are made of."""

    polydispersity: Fraction = Field(description="delta.")
    friction: Ratio = Field(description="Between disks.")


class SurveyedGroup(SceneGroup):
    """A group that may leave packings to the survey."""

    survey_file: Path | None = Field(None, description="Stored packings of the survey; null: there are none.")

    @property
    def surveyed(self) -> bool:
        """Whether it does so."""
        return False

    def checks(self) -> Checks:
        yield (
            "survey_file",
            self.survey_file or not self.surveyed,
            "must be named where packings are left to the survey",
        )
