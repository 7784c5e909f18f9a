"""Parameters that several groups share."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from granular_response.scene.errors import Problem
from granular_response_paper.parameters import Path, SceneGroup


class SurveyedGroup(SceneGroup):
    """A group that may leave packings to the survey."""

    survey_file: Path | None = Field(None, description="Stored packings of the survey; null: there are none.")

    @property
    def surveyed(self) -> bool:
        """Whether it leaves any."""
        raise NotImplementedError

    @model_validator(mode="after")
    def _check_survey(self) -> Self:
        if self.survey_file is None and self.surveyed:
            raise Problem("must be named where packings are left to the survey", key=("survey_file",), value=None)
        return self
