"""Parameters of the slab prepared in several ways."""

from __future__ import annotations

from itertools import product
from typing import Annotated, Any, Literal

from pydantic import Field

from granular_response.scene import Scene, SceneError
from granular_response.scene.base import Count, Description, Fraction, Positive, Ratio
from granular_response.scene.errors import NotAllowed
from granular_response_paper.parameters import UNIT_LOAD, Checked, Checks, Growing, SceneGroup, Some, over

#: Keys of a scene that say how it came to rest.
PREPARES = ("preparation.gravity", "preparation.ramp_time", "contact.damping_ratio")


class Way(Checked):
    """A way to prepare the slab."""

    name: str
    changes: dict[str, Any] = Field(description="To the base scene, by dotted key.")

    def checks(self) -> Checks:
        yield "changes", set(self.changes) <= set(PREPARES), f"must have keys among {', '.join(PREPARES)}"


class TapSeries(Description):
    """Taps of a slab at rest: the box moves by one period of a triangular wave of vertical acceleration, up first."""

    number: Count
    amplitudes: Some[Positive] = Field(description="Largest accelerations, in g.")
    durations: Some[Positive] = Field(description="Of the period, in sqrt(R/g).")


class SlabFamily(Description):
    """Slabs of one friction between disks, ordered or with one polydispersity."""

    friction: Ratio
    walls: Literal["smooth", "rough"] = Field(default="smooth", description="rough: friction of the walls too.")
    ways: tuple[str, ...] = Field(default=(), description="Names of preparations; none: all of them.")
    to: Positive = Field(description="Largest force, in mean disk weights.")
    polydispersity: Fraction = Field(default=0.0, description="delta; the largest disks touch in the initial lattice.")
    realizations: Count = Field(default=1, description="Of the disorder.")
    taps: TapSeries | None = Field(default=None, description="Before the load, in each combination; none: untapped.")

    @property
    def tapped(self) -> list[tuple[int, float, float]]:
        """Number, amplitude and duration of the taps of each slab; zeros: untapped."""
        if self.taps is None:
            return [(0, 0.0, 0.0)]
        return [(self.taps.number, *one) for one in product(self.taps.amplitudes, self.taps.durations)]


class Parameters(SceneGroup):
    scene: Annotated[
        Scene, over(UNIT_LOAD, "packing.polydispersity", "contact.friction", "wall.friction", "preparation", "loads")
    ] = UNIT_LOAD
    ways: Some[Way] = Field(description="The first one is what the others are compared with.")
    forces: Growing = Field(description="In mean disk weights.")
    parts: Some[SlabFamily] = Field(description="The first one is ordered and untapped.")
    asymmetry: Positive = Field(description="Asymmetry of the response from which symmetry is lost.")

    def checks(self) -> Checks:
        names = [way.name for way in self.ways]
        yield "ways", len(set(names)) == len(names), "must have different names"
        for k, way in enumerate(self.ways):
            try:
                self.scene.updated(way.changes)
            except SceneError as error:
                raise NotAllowed(str(error), key=("ways", k)) from None
        yield "parts.0.polydispersity", not self.parts[0].polydispersity, "must be 0"
        yield "parts.0.taps", self.parts[0].taps is None, "must be left out"
        for k, part in enumerate(self.parts):
            known = set(part.ways) <= set(names)
            yield f"parts.{k}.ways", known, f"must be among the names in ways ({', '.join(names)})"
            yield f"parts.{k}.to", part.to >= self.forces[0], "must not be below the first of forces"
