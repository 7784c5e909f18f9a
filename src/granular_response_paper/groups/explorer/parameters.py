"""Parameters of the slabs of the page's explorer."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from granular_response.scene import Scene
from granular_response.scene.base import Description, Fraction, Positive, Ratio
from granular_response_paper.parameters import UNIT_LOAD, Growing, SceneGroup, over, some


class Lattice(Description):
    """An ordered slab; its walls are those of the base scene."""

    friction: Ratio
    stiffness_ratio: Ratio


class Disordered(Description):
    """A disordered slab; its walls have the friction of the disks."""

    polydispersity: Annotated[Fraction, Field(gt=0)]
    friction: Ratio
    largest_force: Positive = Field(description="Last of the forces, if the packing does not collapse before.")


class Parameters(SceneGroup):
    """Section ``explorer``."""

    scene: Annotated[
        Scene,
        over(UNIT_LOAD, "packing.polydispersity", "packing.lattice_constant", "contact.friction", "loads", "protocol"),
    ] = Field(description="Of the lattices; disordered slabs have its stiffness_ratio too.")
    forces: Growing = Field(description="In mean disk weights.")
    lattices: Annotated[tuple[Lattice, ...], AfterValidator(some)]
    disordered: Annotated[tuple[Disordered, ...], AfterValidator(some)]
    stop_kinetic_energy: Positive = Field(description="Of the fall of a disordered slab.")
    collapse_depth: Positive = Field(description="Of the loaded disk, beyond which a slab counts as collapsed.")
    width: Positive = Field(description="w of the Gaussian that smooths the response of a disordered slab.")
