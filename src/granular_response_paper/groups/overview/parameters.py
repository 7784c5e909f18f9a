"""Parameters of the overview."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Description, Fraction, Positive, Ratio
from granular_response_paper.parameters import UNIT_LOAD, Coefficients, Curve, SceneGroup, Some, over


class Experiment(Description):
    """Packings of photoelastic disks (Sec. II.B); floor and walls rub as the disks."""

    polydispersities: Some[Fraction] = Field(description="One packing each.")
    friction: Ratio
    force: Positive = Field(description="In mean disk weights.")
    stop_kinetic_energy: Positive = Field(description="Of the fall of a disordered packing.")


class Parameters(SceneGroup):
    scene: Annotated[
        Scene, over(UNIT_LOAD, "packing.polydispersity", "packing.lattice_constant", "contact.friction", "loads")
    ] = Field(description="Base scene; the walls are those of the ordered slabs.")
    frictions: Coefficients
    forces: Curve[Positive] = Field(
        description="In mean disk weights: frames; the first and the last are in the picture."
    )
    experiment: Experiment
