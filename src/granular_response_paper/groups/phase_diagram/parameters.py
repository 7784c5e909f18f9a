"""Parameters of the phase diagram, measured on stored ensembles."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Count, Description, Fraction, Index, Part, Positive, Ratio
from granular_response_paper.parameters import Counts, Path, Positives, Some


class Compared(Description):
    """Under which force the starts of one polydispersity are compared."""

    polydispersity: Fraction
    force: Positive


class Parameters(Description):
    survey: Path = Field(description="Folder with the datasets of the survey.")
    blocks: Some[str] = Field(description="Blocks of the survey with one case for each point of the diagram.")
    linear_range: str = Field(description="Block of the survey with small forces and smooth walls.")
    linear_width: Positive = Field(description="w of the smoothing Gaussian there, in radii.")
    widths: Positives = Field(description="w of the smoothing Gaussian, in radii.")
    reach: Positive = Field(description="Largest distance at which a peak is looked for, in radii.")
    spacing: Positive = Field(description="Of the x axis, in radii.")
    tolerance: Ratio = Field(description="Shape from which on a response has two peaks.")
    other_tolerances: Some[Ratio] = Field(description="Tried beside it.")
    compared: Some[Compared]
    draws: Count = Field(description="Of the bootstrap over realizations.")
    seed: Index = Field(description="Of the bootstrap.")
    numbers: Counts = Field(description="Of realizations in the paper's means: Fig. 21, Fig. 19.")
    least_part: Part = Field(description="Part of the realizations that must be at rest.")
