"""Parameters of the slab prepared in several ways."""

from __future__ import annotations

from itertools import product
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from granular_response.scene import Scene, SceneError
from granular_response.scene.base import Count, Description, Fraction, Positive, Ratio
from granular_response.scene.errors import Problem
from granular_response_paper.parameters import UNIT_LOAD, Growing, SceneGroup, over

#: Keys of a scene that say how it came to rest.
PREPARES = ("preparation.gravity", "preparation.ramp_time", "contact.damping_ratio")


class Way(Description):
    """A way to prepare the slab."""

    name: Annotated[str, Field(strict=True, min_length=1)]
    changes: dict[str, Any] = Field(description="To the base scene, by dotted key.")

    @model_validator(mode="after")
    def _check(self) -> Way:
        unknown = [key for key in self.changes if key not in PREPARES]
        if unknown:
            raise Problem(f"must be one of {', '.join(PREPARES)}", key=("changes", unknown[0]))
        return self


class Taps(Description):
    """Taps of a slab at rest: the box moves by one period of a triangular wave of vertical acceleration, up first."""

    number: Count
    amplitudes: tuple[Positive, ...] = Field(min_length=1, description="Largest accelerations, in g.")
    durations: tuple[Positive, ...] = Field(min_length=1, description="Of the period, in sqrt(R/g).")


class Part(Description):
    """Slabs of one friction between disks, ordered or with one polydispersity."""

    friction: Ratio
    walls: Literal["smooth", "rough"] = Field(default="smooth", description="rough: friction of the walls too.")
    ways: tuple[str, ...] = Field(default=(), description="Names of preparations; none: all of them.")
    to: Positive = Field(description="Largest force, in mean disk weights.")
    polydispersity: Fraction = Field(default=0.0, description="delta; the largest disks touch in the initial lattice.")
    realizations: Count = Field(default=1, description="Of the disorder.")
    taps: Taps | None = Field(default=None, description="Before the load, in each combination; none: untapped.")

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
    ways: tuple[Way, ...] = Field(min_length=1, description="The first one is what the others are compared with.")
    forces: Growing = Field(description="In mean disk weights.")
    parts: tuple[Part, ...] = Field(min_length=1, description="The first one is ordered and untapped.")
    asymmetry: Positive = Field(description="Asymmetry of the response from which symmetry is lost.")

    @model_validator(mode="after")
    def _check(self) -> Parameters:
        names = [way.name for way in self.ways]
        if len(set(names)) < len(names):
            raise Problem("must have different names", key=("ways",), value=names)
        for k, way in enumerate(self.ways):
            try:
                self.scene.updated(way.changes)
            except SceneError as error:
                raise Problem(str(error), key=("ways", str(k))) from None
        if self.parts[0].polydispersity:
            raise Problem("must be 0", key=("parts", "0", "polydispersity"), value=self.parts[0].polydispersity)
        if self.parts[0].taps:
            raise Problem("must be left out", key=("parts", "0", "taps"), value=self.parts[0].taps.model_dump())
        for k, part in enumerate(self.parts):
            for name in part.ways:
                if name not in names:
                    rule = f"must be one of the names in ways ({', '.join(names)})"
                    raise Problem(rule, key=("parts", str(k), "ways"), value=name)
            if part.to < self.forces[0]:
                raise Problem("must not be below the first of forces", key=("parts", str(k), "to"), value=part.to)
        return self
