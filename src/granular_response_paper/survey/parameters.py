"""Parameters of the survey: blocks of cases, each a file of its own."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

from pydantic import Field

from granular_response.scene.base import Count, Description, Positive, Ratio
from granular_response.scene.lattice import LatticeConstant
from granular_response_paper.ensembles.parameters import Case, EnsembleGroup, Spreads
from granular_response_paper.parameters import Coefficients, Growing, Some


class Cases(Description):
    """Every combination of polydispersities, frictions, starts and ramps of gravity under the same forces."""

    polydispersities: Spreads
    frictions: Coefficients
    forces: Growing = Field(description="In mean disk weights.")
    lattice_constants: Some[LatticeConstant] | None = Field(
        default=None, description="Of the starts; null: that of the scene."
    )
    wall_friction: Ratio | None = Field(default=None, description="null: the same as between disks.")
    gravity_ramps: Some[Positive] | None = Field(
        default=None, description="Over which gravity grows, in sqrt(R/g); null: it acts at once."
    )
    realizations: Count | None = Field(default=None, description="null: those of the survey.")


class Parameters(EnsembleGroup):
    """The survey's own parameter file. Realizations are those of ``polydisperse_averages`` and further ones."""

    realizations: Count
    blocks: Mapping[str, tuple[Cases, ...]]

    def cases(self, block: str) -> list[Case]:
        """The cases of a block. Raises KeyError if there is no such block."""
        found = []
        for entry in self.blocks[block]:
            starts = entry.lattice_constants or (self.lattice_constant,)
            number = entry.realizations or self.realizations
            ramps = entry.gravity_ramps or (None,)
            for delta, mu, start, ramp in product(entry.polydispersities, entry.frictions, starts, ramps):
                packings = number if delta else 1
                found.append(Case(delta, mu, start, entry.forces, packings, entry.wall_friction, ramp))
        return found
