"""Parameters of ensembles: what makes a realization of a disordered slab."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Fraction, Part, Positive
from granular_response_paper.parameters import MATERIAL, UNIT_LOAD, SceneGroup, Some, over

Spreads = Some[Fraction]


@dataclass(frozen=True)
class Case:
    """One column of an ensemble."""

    polydispersity: float
    friction: float
    lattice_constant: float | str
    forces: tuple[float, ...]
    realizations: int
    wall_friction: float | None = None  #: None: the same as between disks
    gravity_ramp: float | None = None  #: time over which gravity grows; None: it acts at once


class EnsembleGroup(SceneGroup):
    """What makes a realization of a disordered slab.

    ``scene`` holds the lattice constant of the start and what ends the fall.
    """

    scene: Annotated[Scene, over(UNIT_LOAD, *MATERIAL, "loads", "protocol.time_step")] = UNIT_LOAD
    time_step_part: Part = Field(description="Time step over the stability limit of the lightest disk.")
    longest_time_step: Positive = Field(description="Without friction the limit is far beyond what the fall needs.")
    collapse_depth: Positive = Field(description="Of the loaded disk, beyond which a packing counts as collapsed.")

    @property
    def lattice_constant(self) -> float | str:
        """That of the scene."""
        return self.scene.packing.model_dump()["lattice_constant"]
