"""Parameters that several groups share."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Fraction, Ratio
from granular_response_paper.parameters import Checked, Checks, Path, SceneGroup


class Material(Checked):
    """What packings of a case are made of."""

    polydispersity: Fraction = Field(description="delta.")
    friction: Ratio = Field(description="Between disks.")


class SurveyedGroup(SceneGroup):
    """A group that may leave packings to the survey."""

    survey_file: Path | None = Field(None, description="Stored packings of the survey; null: there are none.")

    @property
    def surveyed(self) -> bool:
        """Whether it leaves any."""
        raise NotImplementedError

    def checks(self) -> Checks:
        named = self.survey_file is not None or not self.surveyed
        yield "survey_file", named, "must be named where packings are left to the survey"
