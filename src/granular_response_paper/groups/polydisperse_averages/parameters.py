"""Parameters of the ensembles of polydisperse slabs."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Count, Description, Fraction, Index, Positive, Ratio
from granular_response.scene.lattice import LatticeConstant
from granular_response_paper.ensembles.parameters import Case, EnsembleGroup, Spreads
from granular_response_paper.parameters import Checks, Coefficients, Growing, Positives, Some


class Cases(Description):
    """One friction, of the walls too, at several polydispersities."""

    polydispersities: Spreads
    friction: Ratio
    forces: Growing = Field(description="In mean disk weights.")
    lattice_constant: LatticeConstant | None = Field(default=None, description="null: that of the scene.")
    realizations: Count | None = Field(default=None, description="null: those of the group.")


class Individual(Description):
    """Fig. 19."""

    polydispersity: Fraction
    frictions: Coefficients
    force: Positive
    realizations: Count
    width: Positive


class LinearRange(Description):
    """Fig. 20, with smooth walls."""

    polydispersities: Spreads
    frictions: Coefficients
    forces: Growing
    width: Positive
    tolerance: Positive


class ForcesPicture(Description):
    """Fig. 2."""

    polydispersity: Fraction
    friction: Ratio
    force: Positive
    realization: Index


class Parameters(EnsembleGroup):
    realizations: Count = Field(description="Of a disordered case; a lattice needs one.")
    cases: Some[Cases]
    widths: Positives = Field(description="w of the smoothing Gaussian, in radii.")
    reach: Positive = Field(description="Of the x axis of averages, in radii.")
    spacing: Positive = Field(description="Of the x axis of averages, in radii.")
    individual: Individual
    linear_range: LinearRange
    forces_picture: ForcesPicture

    @property
    def columns(self) -> list[Case]:
        """The cases, one polydispersity each."""
        return [
            Case(
                delta,
                entry.friction,
                entry.lattice_constant or self.lattice_constant,
                entry.forces,
                1 if delta == 0.0 else entry.realizations or self.realizations,
            )
            for entry in self.cases
            for delta in entry.polydispersities
        ]

    def start(self, polydispersity: float) -> float | str:
        """The initial lattice of its first case, which the figures show; that of the scene without a case."""
        same = (case.lattice_constant for case in self.columns if case.polydispersity == polydispersity)
        return next(same, self.lattice_constant)

    @property
    def pictured(self) -> list[int]:
        """The cases that have the realization and the force of Fig. 2."""
        picture = self.forces_picture
        return [
            c
            for c, case in enumerate(self.columns)
            if (case.polydispersity, case.friction) == (picture.polydispersity, picture.friction)
            and picture.realization < case.realizations
            and picture.force in case.forces
        ]

    def checks(self) -> Checks:
        cases, shown = self.columns, self.individual
        yield "cases", any(case.polydispersity for case in cases), "must have a polydispersity above 0"
        yield "forces_picture", self.pictured, "must be a realization and a force of one of the cases"
        alike = [case for case in cases if case.polydispersity == shown.polydispersity and shown.force in case.forces]
        there = any(case.friction in shown.frictions for case in alike)
        yield "individual", there, "must be a polydispersity, frictions and a force of the cases"
