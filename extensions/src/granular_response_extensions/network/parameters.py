"""Parameters of the statistics of contact networks."""

from __future__ import annotations

from pydantic import Field

from granular_response.scene.base import Count, Part, Positive
from granular_response_paper.ensembles.parameters import Case, EnsembleGroup, Spreads
from granular_response_paper.parameters import Checks, Coefficients

#: Contacts are those that lie at least this far from the floor and from the highest disk, in radii.
VERTICAL_MARGIN = 4.0


class Parameters(EnsembleGroup):
    polydispersities: Spreads = Field(description="delta.")
    frictions: Coefficients = Field(description="Between disks, of floor and walls.")
    realizations: Count = Field(description="Of each polydispersity and friction.")
    force: Positive = Field(description="Of the load, in mean disk weights.")
    band: Positive = Field(description="Height of the bands in which forces are relative to their mean, in radii.")
    margin: Part = Field(description="Below the Coulomb limit, within which a contact counts as fully mobilized.")

    @property
    def cases(self) -> dict[tuple[int, int], Case]:
        """By the places of polydispersity and friction."""
        return {
            (d, m): Case(delta, friction, self.lattice_constant, (self.force,), self.realizations)
            for d, delta in enumerate(self.polydispersities)
            for m, friction in enumerate(self.frictions)
        }

    def checks(self) -> Checks:
        yield "polydispersities", min(self.polydispersities) > 0.0, "must be above 0: a lattice has one realization"
        high = bool(self.scene.packing.build().position[:, 1].max() > 2.0 * VERTICAL_MARGIN)
        rule = f"must be more: contacts nearer than {VERTICAL_MARGIN:g} radii to floor or top are left out"
        yield "scene.packing.layers", high, rule
