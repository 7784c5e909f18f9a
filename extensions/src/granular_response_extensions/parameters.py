"""Parameters that several groups share."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Description, Fraction, Ratio
from granular_response_paper.parameters import Path, SceneGroup


class Material(Description):
    """What packings of a case are made of."""

    polydispersity: Fraction = Field(description="delta.")
    friction: Ratio = Field(description="Between disks.")


class SurveyedGroup(SceneGroup):
    """A group that may leave packings to the survey."""

    survey_file: Path | None = Field(None, description="Stored packings of the survey; null: there are none.")
