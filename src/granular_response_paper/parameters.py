"""The parameters of figure groups: one validated description for each section of ``params.yaml``.

A group's ``parameters.py`` has a class ``Parameters``. Its base scene is written as a partial scene: what it does not
name is that of the group's own base, so one key of it can be tried alone
(``dvc exp run -S pile_dip.scene.contact.friction=0.5``). A mistake is a SceneError of one line, as in a scene file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import reduce
from itertools import pairwise
from typing import Annotated, Any, Self, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from granular_response.scene import Scene, SceneError
from granular_response.scene.base import Count, Description, Positive, Ratio, allowed
from granular_response.scene.errors import NotAllowed, must
from granular_response.scene.protocol import Method

Entry = TypeVar("Entry")


def refused_unless(holds: Callable[[Any], object], rule: str) -> AfterValidator:
    """Validates a value of which something must hold."""

    def check(value: Any) -> Any:
        must(holds(value), rule)
        return value

    return AfterValidator(check)


_EACH_ONCE = refused_unless(lambda values: len(set(values)) == len(values), "must have each entry once")
_GROWING = refused_unless(lambda values: all(a < b for a, b in pairwise(values)), "must be growing numbers")

#: Lists with an entry or more, with two or more, with different ones, with growing numbers, and curves of two or more.
Some = Annotated[tuple[Entry, ...], refused_unless(len, "must have at least one entry")]
Several = Annotated[
    tuple[Entry, ...], refused_unless(lambda values: len(values) > 1, "must have at least two entries, to compare")
]
Different = Annotated[Some[Entry], _EACH_ONCE]
Growing = Annotated[Some[Positive], _GROWING]
Curve = Annotated[Several[Entry], _GROWING]
Positives = Different[Positive]
#: Coefficients of friction, ratios.
Coefficients = Different[Ratio]
Counts = Different[Count]
#: With a middle one.
Odd = refused_unless(lambda number: number % 2, "must be odd")
#: Of rows, or of disks over rows.
Rows = Annotated[int, Field(strict=True, ge=2), allowed("must be a whole number from 2 on")]
Path = Annotated[str, Field(strict=True, min_length=1), allowed("must be the path of a file")]


#: Of parameters that must agree: the dotted key that a message names, whether all is well, else what is allowed.
Checks = Iterator[tuple[str, object, str]]


class Checked(Description):
    """A description whose parameters must agree."""

    def checks(self) -> Checks:
        """In turn; the first that fails is the mistake."""
        yield from ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        for key, holds, rule in self.checks():
            path = [int(part) if part.isdigit() else part for part in key.split(".")]
            must(holds, rule, key=path, value=None if holds else _shown(reduce(_part, path, self)))
        return self


def _part(of: Any, name: str | int) -> Any:
    return of[name] if isinstance(name, int) else getattr(of, name)


def _shown(value: Any) -> Any:
    """A parameter as its file has it."""
    if isinstance(value, tuple):
        return [_shown(one) for one in value]
    return value.model_dump() if isinstance(value, Description) else value


class Common(Checked):
    """What ``common`` holds for every group that solves scenes; a group's own section may have it too."""

    method: Method = Field(description="protocol.method of the scenes.")


class Loading(Description):
    """Growing forces on a slab, in mean disk weights."""

    friction: Ratio = Field(description="Between disks.")
    forces: Growing


class EqualRows(Description):
    """The text's own geometry: as many disks in every row."""

    layers: Count
    disks: Count


class SceneGroup(Common):
    """A group whose scenes are changes to one base scene."""

    scene: Scene

    @property
    def base(self) -> Scene:
        """The base scene, solved by ``method``."""
        return self.scene.updated({"protocol.method": self.method})


#: The paper's scene with a load of one disk weight, so that load factors are forces.
UNIT_LOAD = Scene().updated({"loads.0.force": [0.0, -1.0]})


#: Keys of a scene that groups decide together: how large a packing is, and its disorder and friction.
SIZE = ("packing.layers", "packing.disks_per_row")
MATERIAL = ("packing.polydispersity", "packing.realization", "contact.friction", "wall.friction")


def material(polydispersity: float, realization: int, friction: float, walls: float | None = None) -> dict[str, float]:
    """Changes to a scene: the values of :data:`MATERIAL`; ``walls`` None is as much friction as between disks."""
    given = (polydispersity, realization, friction, friction if walls is None else walls)
    return dict(zip(MATERIAL, given, strict=True))


def over(base: Scene, *decided: str) -> BeforeValidator:
    """Validates a partial scene: changes to ``base``, by keys of any depth.

    ``decided`` are keys that the group sets itself, for which a value in the partial scene would mean nothing; the
    method is one of them. The kind of packing stays that of ``base``.
    """
    refused = ("protocol.method", *decided)
    kind = base.to_dict()["packing"]["kind"]

    def complete(given: Any) -> Any:
        if isinstance(given, Scene):
            return given
        must(isinstance(given, Mapping), "must be a mapping with keys of a scene")
        for path, value in leaves(given):
            name = ".".join(path)
            must(name != "packing.kind" or value == kind, f"must be {kind} in this group", key=path, value=value)
            own = any(f"{name}.".startswith(f"{key}.") for key in refused)
            must(not own, "is decided by the group, by keys of its own; must not be given", key=path, value=value)
        try:
            return base.merged(given)
        except SceneError as error:
            raise NotAllowed(str(error)) from None

    return BeforeValidator(complete)


def leaves(given: Mapping, above: Sequence[str] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Values with their paths, whether these are written dotted or nested."""
    for key, value in given.items():
        path = (*above, *str(key).split("."))
        if isinstance(value, Mapping):
            yield from leaves(value, path)
        else:
            yield path, value
