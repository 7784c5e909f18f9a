"""Parameters of the elastic moduli of packings, and of the slab that they predict."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from granular_response.scene import Scene
from granular_response.scene.base import Count, Description, Fraction, Index, Part, Positive, Ratio, allowed
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import MATERIAL, SIZE, UNIT_LOAD, Growing, Positives, SurveyedGroup, over, some

Rows = Annotated[int, Field(strict=True, ge=5), allowed("must be a whole number from 5 on")]
Margin = Annotated[float, Field(strict=True, ge=0, lt=0.4), allowed("must be from 0 to below 0.4")]


class Case(Description):
    """Packings of one material."""

    polydispersity: Fraction = Field(description="delta.")
    friction: Ratio = Field(description="Between disks and of the floor.")
    layers: Annotated[tuple[Rows, ...], AfterValidator(some)] = Field(description="Sizes.")
    realizations: Annotated[tuple[Index, ...], AfterValidator(some)] = Field(description="As many for each size.")
    surveyed: tuple[Index, ...] = Field((), description="Further ones for each size, that the survey simulates.")

    @property
    def further(self) -> tuple[int, ...]:
        """Realizations of the survey for each size."""
        return self.surveyed or (0,) * len(self.layers)

    @model_validator(mode="after")
    def _check_realizations(self) -> Case:
        for key, counts in (("realizations", self.realizations), ("surveyed", self.further)):
            if len(counts) != len(self.layers):
                raise Problem("must have a number for each of the layers", key=(key,), value=list(counts))
        if not all(map(sum, zip(self.realizations, self.further, strict=True))):
            rule = "must be 1 or more for each of the layers, with those of the survey"
            raise Problem(rule, key=("realizations",), value=list(self.realizations))
        return self


class Lattice(Description):
    """Slabs of equal disks, horizontal contacts closed or open."""

    friction: Positive = Field(description="Between disks, so that none slides.")
    layers: Rows = Field(description="Rows of the lattices that are strained; their answer depends on no width.")
    closed: Positive = Field(description="Lattice constant at which neighbours in a row touch.")
    open: Positive = Field(description="Lattice constant at which they do not.")
    stiffness_ratios: Growing = Field(description="k_T / k_N.")
    responding: Annotated[tuple[Rows, ...], AfterValidator(some)] = Field(
        description="Odd numbers of rows of the lattices whose response is looked at."
    )
    responding_ratios: Growing = Field(description="k_T / k_N of these.")

    @model_validator(mode="after")
    def _check_odd(self) -> Lattice:
        if any(layers % 2 == 0 for layers in self.responding):
            raise Problem("must be odd, a floor disk below the load", key=("responding",), value=list(self.responding))
        return self


class Parameters(SurveyedGroup):
    """Section ``moduli``."""

    scene: Annotated[Scene, over(UNIT_LOAD, *SIZE, *MATERIAL, "packing.sides", "packing.lattice_constant", "loads")] = (
        Field(description="Base scene.")
    )
    disks_per_layer: Count = Field(description="Disks of a row over number of rows.")
    margin: Margin = Field(description="Part of the rows at either end over which no modulus is averaged.")
    width: Positive = Field(description="w of the Gaussian over the response, in radii.")
    wide: Part = Field(description="w of a second one, as a part of the height.")
    cases: Annotated[tuple[Case, ...], AfterValidator(some)] = Field(description="Disordered packings.")
    tolerances: Positives = Field(description="Differences to the elastic slab for which a size is looked for.")
    draws: Count = Field(description="Of the bootstrap over realizations that gives these sizes an interval.")
    seed: Index = Field(description="Of these draws.")
    lattice: Lattice = Field(description="Packings with moduli in closed form.")

    @property
    def surveyed(self) -> bool:
        return any(any(case.surveyed) for case in self.cases)
