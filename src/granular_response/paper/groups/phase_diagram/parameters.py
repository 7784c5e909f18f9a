"""Parameters of the phase diagram, measured on stored ensembles."""

from __future__ import annotations

from pydantic import Field

from granular_response.paper.parameters import Part, Path, Positives
from granular_response.scene.base import Count, Description, Index, Positive


class Parameters(Description):
    """Section ``phase_diagram``."""

    responses: Path = Field(description="File with the datasets of polydisperse_averages.")
    widths: Positives = Field(description="w of the smoothing Gaussian, in radii.")
    reach: Positive = Field(description="Largest distance at which a peak is looked for, in radii.")
    spacing: Positive = Field(description="Of the x axis, in radii.")
    draws: Count = Field(description="Of the bootstrap over realizations.")
    seed: Index = Field(description="Of the bootstrap.")
    few: Count = Field(description="Size of the small averages.")
    least_part: Part = Field(description="Part of the realizations that must be at rest.")
