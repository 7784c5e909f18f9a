"""Parameters of the width of the response against depth."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Fraction, Index, Part, Positive, Ratio
from granular_response.scene.errors import Problem
from granular_response.state import FloatArray
from granular_response_paper.parameters import (
    MATERIAL,
    SIZE,
    UNIT_LOAD,
    Counts,
    Rows,
    SurveyedGroup,
    growing,
    over,
    some,
)

#: Least number of realizations that are drawn from for an interval.
LEAST_REALIZATIONS = 3


class Case(Description):
    """Packings of one material under one load, at several heights."""

    polydispersity: Fraction = Field(description="delta.")
    friction: Ratio = Field(description="Between disks, of floor and walls.")
    gravity: Literal["at-once", "frictionless"] = Field("at-once", description="How gravity is applied.")
    force: Positive | None = Field(
        None,
        description="On the disk at the top centre of a slab of the reference height; it grows as the square of the "
        "number of layers, as the weight of what bears it. Null: the limit of small forces on disks of the top row.",
    )
    layers: Counts = Field(description="Numbers of rows, growing; the stress inside is that of the last one.")
    surveyed: tuple[Count, ...] = Field((), description="Further ones, growing on, that the survey simulates.")
    realizations: Count = Field(1, description="Of each height; one is all there are of a lattice.")

    surveyed_realizations: Count | None = Field(None, description="Of those of the survey; null: as many.")

    def count(self, height: int) -> int:
        """Realizations of one of :attr:`heights`."""
        return self.realizations if height < len(self.layers) else self.surveyed_realizations or self.realizations

    @property
    def heights(self) -> tuple[int, ...]:
        """All numbers of rows."""
        return (*self.layers, *self.surveyed)

    @model_validator(mode="after")
    def _check(self) -> Case:
        for key, numbers in (("layers", self.layers), ("surveyed", self.heights)):
            try:
                growing(numbers)
            except Problem:
                raise Problem("must be growing numbers", key=(key,), value=list(getattr(self, key))) from None
        for key, number in (
            ("realizations", self.realizations),
            ("surveyed_realizations", self.surveyed_realizations or self.realizations),
        ):
            if number < LEAST_REALIZATIONS and self.polydispersity > 0.0:
                rule = f"must be at least {LEAST_REALIZATIONS} with polydispersity, for an interval"
                raise Problem(rule, key=(key,), value=number)
        return self


class Parameters(SurveyedGroup):
    """Section ``peak_width``."""

    scene: Annotated[Scene, over(UNIT_LOAD, *SIZE, *MATERIAL, "preparation.gravity", "loads")] = Field(
        description="Base scene; contact.normal_stiffness is that at the reference height."
    )
    reference_layers: Count = Field(
        description="Rows at which stiffness and forces are as given. Stiffness grows as the number of rows, so that "
        "gravity compresses all slabs by the same part."
    )
    disks_per_layer: Rows = Field(description="Disks of a row over number of rows, and one more.")
    cases: Annotated[tuple[Case, ...], AfterValidator(some)] = Field(description="Materials and loads.")
    loads: Count = Field(description="Small loads on a disordered packing, one after another; one on a lattice.")
    margin: Positive = Field(description="Of these loads from the side walls, in heights.")
    width: Positive = Field(description="w of the Gaussian along x, in radii.")
    lines: Count = Field(description="Most lines between rows on which the stress is taken.")
    reach: Positive = Field(description="Of the profiles from the load, in depths.")
    spacing: Positive = Field(description="Of the profiles, in depths.")
    tolerance: Part = Field(
        description="Of the maximum, by which it must exceed the value on the axis to be one of two peaks."
    )
    fitted: tuple[Positive, Positive] = Field(
        description="Least depth that is fitted inside a slab, in radii, and the largest, in heights of the slab."
    )
    draws: Count = Field(description="Of the bootstrap over realizations.")
    seed: Index = Field(description="Of the draws.")

    @property
    def surveyed(self) -> bool:
        return any(case.surveyed for case in self.cases)

    @property
    def grid(self) -> FloatArray:
        """Distances from the axis, in depths."""
        return np.arange(round(self.reach / self.spacing) + 1, dtype=float) * self.spacing

    @model_validator(mode="after")
    def _check(self) -> Parameters:
        if self.spacing >= 0.1 * self.reach:
            raise Problem("must be below a tenth of reach", key=("spacing",), value=self.spacing)
        return self
