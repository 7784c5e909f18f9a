"""Parameters of the crossover force against the size of a slab."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import xarray as xr
from pydantic import Field

from granular_response.scene import Scene
from granular_response.scene.base import Positive, Ratio, Sides
from granular_response.state import FloatArray
from granular_response_extensions.parameters import SurveyedGroup
from granular_response_paper.parameters import SIZE, UNIT_LOAD, Checked, Checks, Growing, Odd, Some, over

#: Rest without friction is found by statics at every size, and is the same preparation for all.
_SLAB = UNIT_LOAD.updated({"preparation.gravity": "frictionless", "contact.stiffness_ratio": 0.8})
_DECIDED = (
    "packing.sides", "packing.lattice_constant", "packing.polydispersity", "contact.friction",
    "contact.normal_stiffness", "wall.normal_stiffness", "loads",
)  # fmt: skip

#: What may differ along a series.
VARIED = ("layers", "disks_per_layer", "stiffness_per_layer", "confinement")


Layers = Annotated[int, Field(strict=True, ge=5), Odd]


class Series(Checked):
    """Slabs that differ in one quantity: the list that has several entries."""

    name: str
    friction: Ratio = Field(description="Between disks; floor and walls are smooth.")
    sides: Sides = "periodic"
    layers: Some[Layers] = Field(description="Odd, so that a disk of the floor is below the loaded one.")
    surveyed: tuple[Layers, ...] = Field((), description="Further ones, growing on, that the survey simulates.")
    disks_per_layer: Growing = Field(
        (3.0,), description="Disks in a row over layers; rows have the next odd number, for a disk in the middle."
    )
    stiffness_per_layer: Growing = Field((200.0,), description="Normal stiffness over layers.")
    confinement: Growing = Field(
        (0.15,),
        description="Force of horizontal contacts before gravity acts, in mean disk weights; periodic sides only.",
    )
    confined: Literal["constant", "as weight"] = Field(
        "constant", description="as weight: this force is that of 15 layers, and in proportion to layers."
    )

    def checks(self) -> Checks:
        yield "surveyed", self.heights == tuple(sorted({*self.heights})), "must be growing numbers, after layers"
        several = sum(map(self._several, VARIED))
        yield "name", several == 1, f"must have several entries in one of {', '.join(VARIED)}"

    @property
    def varied(self) -> str:
        """The quantity that has several entries."""
        return next(name for name in VARIED if self._several(name))

    @property
    def heights(self) -> tuple[int, ...]:
        """All numbers of layers."""
        return (*self.layers, *self.surveyed)

    def _several(self, name: str) -> bool:
        return len(self.heights if name == "layers" else getattr(self, name)) > 1


def varied(slabs: xr.Dataset, name: str) -> FloatArray:
    """(slab,) what differs along a series that varies ``name``, as it came to be."""
    per = {"disks_per_layer": "disks_per_row", "stiffness_per_layer": "normal_stiffness"}
    found = slabs[per.get(name, name)].values
    return np.asarray(found / slabs["layers"].values if name in per else found, float)


class Parameters(SurveyedGroup):
    scene: Annotated[Scene, over(_SLAB, *SIZE, *_DECIDED)] = Field(
        _SLAB, description="Base scene; walls are twice as stiff as the disks."
    )
    series: Some[Series] = Field(description="Slabs that are compared.")
    visible: Positive = Field(description="Dip of the floor response at x = 0, per largest value, that is two peaks.")
    first_force: Positive = Field(description="Least force, over the force of horizontal contacts at rest.")
    factor: float = Field(strict=True, gt=1, le=2, description="Each force over the one before.")
    most_forces: int = Field(strict=True, ge=5, description="Forces after which a slab is given up.")
    tolerance: Positive = Field(description="Width of brackets without friction, per force.")
    extrapolated: Positive = Field(description="Layers to which crossovers are extrapolated.")

    @property
    def surveyed(self) -> bool:
        return any(one.surveyed for one in self.series)

    def checks(self) -> Checks:
        yield from super().checks()
        yield "series", len({one.name for one in self.series}) == len(self.series), "must have different names"
