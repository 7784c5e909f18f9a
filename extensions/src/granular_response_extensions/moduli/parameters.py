"""Parameters of the elastic moduli of packings and of loaded slabs, and of the elastic slabs with them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Count, Index, Part, Positive
from granular_response_extensions.parameters import Material, SurveyedGroup
from granular_response_paper.parameters import (
    MATERIAL,
    SIZE,
    UNIT_LOAD,
    Checked,
    Checks,
    Growing,
    Loading,
    Rows,
    Some,
    over,
)

#: The elastic solid of a loaded slab has the triangles of a lattice, smooth walls and no rotations.
_OF_A_LATTICE = (
    "packing.polydispersity", "packing.sides", "contact.friction", "contact.rolling_friction", "wall", "loads",
)  # fmt: skip


class SizedMaterial(Material, Checked):
    """Packings of several sizes; the floor rubs as the disks."""

    layers: Some[Rows] = Field(description="Sizes.")
    realizations: Some[Index] = Field(description="As many for each size.")
    surveyed: tuple[Index, ...] = Field((), description="Further ones for each size, that the survey simulates.")

    def checks(self) -> Checks:
        for key, counts in (("realizations", self.realizations), ("surveyed", self.further)):
            yield key, len(counts) == len(self.layers), "must have a number for each of the layers"
        each = all(map(sum, zip(self.realizations, self.further, strict=True)))
        yield "realizations", each, "must be 1 or more for each of the layers, with those of the survey"

    @property
    def further(self) -> tuple[int, ...]:
        """Realizations of the survey for each size."""
        return self.surveyed or (0,) * len(self.layers)


class LoadedSlab(Loading):
    """A slab under a growing force."""

    shown: Positive = Field(description="The force whose map is drawn, or the next one above it.")


class LoadedSlabs(Checked):
    """Incremental moduli of lattices under load."""

    scene: Annotated[Scene, over(UNIT_LOAD, *_OF_A_LATTICE)] = Field(default=UNIT_LOAD, description="A lattice.")
    slabs: Some[LoadedSlab] = Field(description="One for each friction.")
    widths: Growing = Field(description="w of the Gaussian over which fields are averaged, in radii.")
    smoothing: Positive = Field(description="w of the Gaussian under which floor responses are compared, in radii.")
    horizontal_waves: Count = Field(description="Highest half waves of body forces along x.")
    vertical_waves: Count = Field(description="Highest half waves of body forces along z.")

    def checks(self) -> Checks:
        layers = self.scene.packing.model_dump()["layers"]
        yield "scene.packing.layers", layers >= 2, "must be 2 or more: one row has no triangles"


class Parameters(SurveyedGroup):
    scene: Annotated[Scene, over(UNIT_LOAD, *SIZE, *MATERIAL, "packing.sides", "packing.lattice_constant", "loads")] = (
        Field(description="Base scene of the packings.")
    )
    disks_per_layer: Count = Field(description="Disks of a row over number of rows.")
    margin: float = Field(
        strict=True, ge=0.0, lt=0.4, description="Part of the rows at either end over which no modulus is averaged."
    )
    width: Positive = Field(description="w of the Gaussian over the response, in radii.")
    wide: Part = Field(description="w of a second one, as a part of the height.")
    cases: Some[SizedMaterial] = Field(description="Disordered packings.")
    loaded: LoadedSlabs = Field(description="Lattices under load.")

    @property
    def lattice(self) -> Scene:
        """The base scene of the slabs under load, solved by ``method``."""
        return self.loaded.scene.updated({"protocol.method": self.method})

    @property
    def surveyed(self) -> bool:
        return any(any(case.surveyed) for case in self.cases)
